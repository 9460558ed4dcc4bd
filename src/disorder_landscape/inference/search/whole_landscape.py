"""The optima of the whole landscape: V of every site, of which only the disorder model is known.

No guess is near enough for Gauss–Newton steps with all data. But the higher μ is, the less V
scatters the electrons back, and the wider the minima of −2 log of the posterior density are. So
steps take the lines of the highest μ first, and add lower and lower ones.

Few data have fewer minima than many. And at a minimum of some data that is not near the true V,
other data seldom have one. So steps go on and on with other data: few points of μ, B and bias,
drawn anew after few steps (as stochastic gradients do: Robbins and Monro, Ann. Math. Stat. 22, 400
(1951)). They take lower μ only when V foretells draws: explains data that no step has used. (Where
they went on as soon as V explained a draw that steps had used, one wire of three was lost.)

At B = 0 slopes in closed form often fail. (One such μ of 48 takes three quarters of the time of a
step with all 480 sets.) So the search leaves it out, and adds it to the optima at last.

At last steps must go to the optimum itself: valleys bend, and steps that are content with less end
some 50 µeV away, where the noise explains the data all but as well. There are other optima near it
where it does so, too. So steps with a draw of fewer lines leave the best one, and go down from
there once more, until enough of these ways have come back to it.

Where μ does not go up so high, a population of wires searches instead (`population`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from disorder_landscape.inference.landscape_hint import highest_and_needed_mu
from disorder_landscape.inference.optimum import Optimum, best, chi_square_excess, is_noise
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.gauss_newton import Goal
from disorder_landscape.inference.search.optima import Optima
from disorder_landscape.inference.search.population import Population
from disorder_landscape.inference.search.steps import Steps
from disorder_landscape.inference.search.wires import Wire
from disorder_landscape.inference.streams import Stream
from disorder_landscape.model.parameters import FloatArray

FEW = 24, 5, 7
"""Points of μ, B and bias, drawn anew each time, at most, …"""
MORE = 48, 5, 11
"""… and of the data that follow before all."""
LINES = range(6, FEW[0] + 1, 2)
"""A way down takes so many lines of the highest μ, one number after the other."""
WAYS_DOWN = 12
"""At most. The first is from the middle of the prior, the others from draws. (Of forty wires of the
paper's disorder 33 arrive by the first, five by the second and two by the third.)"""
DRAWS = 40
"""Steps take lower μ, or a way ends with the lowest, where so many draws have not been enough."""
FORETOLD = 2, 5.0
"""Steps go on until V explains so many draws in a row before steps use them. χ² may be so many of
its standard deviations above its mean: of 3,360 data it is two if all is well, since V is only as
near as the draw before lets it be."""
LOST = 3, 14
"""A way ends early where so many numbers of lines, one after the other, have not been foretold, of
which the last is no more than this. (Of 24 ways with μ up to 3.0 or 4.2 meV that had ended after
two, 21 were more than 400 µeV off. Of the other three one, of 18 lines, arrives if it goes on.)"""
BACK = 5
"""Where more data are not explained then, steps go back to draws, at most so many times."""
AGAIN = range(12, 20, 2)
"""Ways that leave the best optimum begin with so many lines, by turns."""
POPULATIONS = 4
"""At most, where µ is low."""
STARTS = 3, 8
"""At least, and at most: a way down that leads to an optimum that fits, and those that leave it."""


def optima_of_whole_landscape(
    observation: Observation, steps: Steps, seed: int
) -> tuple[Optima, int]:
    """Return the optima that are found, and how many ways down or populations it took."""
    in_fields = _in_fields(observation)
    some = in_fields.on_few_points(*MORE)
    optima = Optima(in_fields, steps, STARTS)
    highest, needed = highest_and_needed_mu(observation)
    is_low, others, attempt = highest < needed, list[Wire](), 0
    for number in range(POPULATIONS if is_low else WAYS_DOWN):
        way: _Way | Population = (
            Population(in_fields, steps, seed, (number,), others)
            if is_low
            else _Way(in_fields, some, steps, seed, (number,))
        )
        x, goal = way.towards_optimum()
        if isinstance(way, Population):
            others = way.wires
        if not (isinstance(way, Population) and way.joined):
            attempt = number
        optima.start_at(x, attempt, goal)
        until = optima.starts + STARTS[1] - 1
        while optima.fits and not optima.is_settled and optima.starts < until:
            again = replace(way, name=(number, optima.starts))
            x, goal = again.from_optimum(best(optima.found))
            optima.start_at(x, attempt, goal)
        if optima.fits:
            break
    return optima.of(observation), number + 1


@dataclass(frozen=True)
class _Way:
    """A way over lower and lower μ: to unknowns, and what steps with all data may reach from there.

    Each of its parts has random numbers of its own, so that an interrupted search goes on alike.
    """

    observation: Observation
    some: Observation
    steps: Steps
    seed: int
    name: tuple[int, ...]

    def towards_optimum(self) -> tuple[FloatArray, Goal]:
        """Go down from V = 0 or a draw of the prior."""
        prior = self.observation.unknowns.white_noise
        x = prior.mean if self.name == (0,) else prior.draw(self._rng(), 2)[0]
        return self._over(LINES, x)

    def from_optimum(self, optimum: Optimum) -> tuple[FloatArray, Goal]:
        """Leave an optimum, and go down from there."""
        first = AGAIN[self.name[-1] % len(AGAIN)]
        x = self._nearer(self._draw(first, self._rng()), optimum.answer.mean)
        return self._over(range(first, LINES.stop, LINES.step), x)

    def _over(self, counts: range, x: FloatArray) -> tuple[FloatArray, Goal]:
        """Return unknowns (unknown,): near an optimum, if they explain data of all μ."""
        lost = 0
        for lines in counts:
            x, foretells = self._foretell(lines, x, lines)
            lost = 0 if foretells else lost + 1
            if lost == LOST[0] and lines <= LOST[1]:
                return x, "place"
        for part in range(LINES.stop, LINES.stop + BACK):
            if not foretells:
                break
            name = f"{self._prefix}.{part}.some"
            x = self.steps.end(self.some, x, self.name[0], name, goal="better").mean
            if is_noise(_excess(self.some, x)):
                return x, "optimum"
            x, foretells = self._foretell(LINES[-1], x, part)
        return x, "place"

    def _foretell(self, lines: int, x: FloatArray, part: int) -> tuple[FloatArray, bool]:
        """Take steps with draws of so many lines until some need none; whether they do."""
        find = partial(self._until_foretold, lines, x, self._rng(part))
        found = self.steps.cache(f"{self._prefix}.{part}", find)
        return np.array(found["x"]), found["foretells"]

    def _until_foretold(
        self, lines: int, x: FloatArray, rng: np.random.Generator
    ) -> dict[str, Any]:
        """Return the unknowns `x` (unknown,), and whether they foretell draws."""
        in_a_row, foretold = FORETOLD
        left = in_a_row
        for _ in range(DRAWS):
            part = self._draw(lines, rng)
            if _excess(part, x) > foretold:
                left = in_a_row
                x = self._nearer(part, x)
                continue
            left -= 1
            if left == 0:
                break
        return {"x": x.tolist(), "foretells": left == 0}

    def _draw(self, lines: int, rng: np.random.Generator) -> Observation:
        return self.observation.on_random_points(lines / FEW[0], (lines, *FEW[1:]), rng)

    def _nearer(self, part: Observation, x: FloatArray) -> FloatArray:
        return self.steps.end(part, x, self.name[0], goal="few").mean

    @property
    def _prefix(self) -> str:
        return ".".join(["way", *map(str, self.name)])

    def _rng(self, *part: int) -> np.random.Generator:
        return np.random.default_rng([self.seed, Stream.SEARCH, *self.name, *part])


def _in_fields(observation: Observation) -> Observation:
    """Return an observation of what was measured at other fields than B = 0, if anything was."""
    m = observation.measurement
    some = observation.at(
        np.arange(m.mu.size), np.flatnonzero(~np.isclose(m.B, 0)), np.arange(m.bias.size)
    )
    return some if some.data.size else observation


def _excess(observation: Observation, x: FloatArray) -> float:
    """Return (χ² − its mean) / its standard deviation at x (unknown,)."""
    return chi_square_excess(observation, observation.simulate(x[None])[0])
