"""The optima of the whole landscape: V of every site, of which only the disorder model is known.

No guess is near enough for Gauss–Newton steps with all data. But the higher μ is, the less V
scatters the electrons back, and the wider the minima of −2 log of the posterior density are. So
steps take the lines of the highest μ first, and add lower and lower ones.

Few data have fewer minima than many. And at a minimum of some data that is not near the true V,
other data seldom have one. So steps go on and on with other data: few points of μ, B and bias,
drawn anew whenever steps have come to an end (as stochastic gradients do: Robbins and Monro, Ann.
Math. Stat. 22, 400 (1951)). V becomes right from both ends inwards, as electrons of low μ do not
reach further. It is found where it explains data that no step has used.

With all data steps must go to the optimum itself: valleys bend, and steps that are content with
less end some 50 µeV away, where the noise explains the data all but as well. Starts about that
optimum, with a new stretch of V each, tell whether there is a better one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from disorder_landscape.inference.checkpoint import Cache, uncached
from disorder_landscape.inference.optimum import best, chi_square_excess, is_noise
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.search.optima import Optima, Steps
from disorder_landscape.model.parameters import FloatArray

FEW = 24, 5, 7
"""Points of μ, B and bias, drawn anew each time, at most, …"""
MORE = 48, 5, 11
"""… and of the data that follow before all."""
HIGHEST = 4
"""A way down begins with so many lines of the highest μ."""
WAYS_DOWN = 5
"""At most. The first is from the middle of the prior, the others from draws."""
DRAWS = 30
"""A way ends where so many draws of data have not led to a V that explains one of them."""
FORETOLD = 2, 5.0
"""With the lowest lines steps go on until V explains so many draws in a row before steps use them.
χ² may be so many of its standard deviations above its mean: of 3,360 data it is two if all is well,
since V is only as near as the draw before lets it be."""
BACK = 5
"""Where more data are not explained then, steps go back to draws, at most so many times."""
STRETCH = 8.0, 35.0
"""Standard deviation of the Gaussian window in which V is drawn anew, in sites: the least and the
largest."""
DRAWN_ANEW = 0.3, 0.45, 0.6
"""Share of the new V in the middle of the window, root mean square; what was there has the rest."""
STARTS = 40
"""At most, after each way down that leads to an optimum that fits, its own end the first."""


def optima_of_whole_landscape(
    observation: Observation, steps: Steps, seed: int, cache: Cache = uncached
) -> tuple[Optima, int]:
    """Return the optima to which steps over lower and lower μ lead, and how many ways down."""
    some = observation.on_few_points(*MORE)
    optima = Optima(observation, some, steps, ("better", "better"))
    for number in range(WAYS_DOWN):
        way = _Way(observation, some, steps, seed, number, cache)
        x, explains = way.down()
        optima.end_at(x, number, "optimum" if explains else "place")
        until = optima.starts + STARTS - 1
        while optima.fits and not optima.is_settled and optima.starts < until:
            optima.start_from(way.back(best(optima.found).answer, optima.starts), number)
        if optima.fits:
            optima.refine(number)
            break
    return optima, number + 1


@dataclass(frozen=True)
class _Way:
    """A way from V = 0, or from a draw of the prior, over lower and lower μ.

    Each of its parts has random numbers of its own, so that an interrupted search goes on alike.
    """

    observation: Observation
    some: Observation
    steps: Steps
    seed: int
    number: int
    cache: Cache

    def down(self) -> tuple[FloatArray, bool]:
        """Return unknowns (unknown,), and whether they explain data of all μ."""
        prior = self.observation.unknowns.prior
        x = prior.mean if self.number == 0 else prior.draw(self._rng(), 2)[0]
        for lines in range(HIGHEST, FEW[0]):
            x, explains = self._cached(lines, partial(self._explain, lines, x, self._rng(lines)))
            if not explains:
                return x, False
        for part in range(FEW[0], FEW[0] + BACK):
            x, _ = self._cached(part, partial(self._foretell, x, self._rng(part)))
            x = self._better(self.some, x, f"{part}.some")
            if is_noise(_excess(self.some, x)):
                return self._better(self.observation, x, "all"), True
        return x, False

    def back(self, answer: Gaussian, start: int) -> FloatArray:
        """Return unknowns that foretell draws of data again, after a change of an answer."""
        part = FEW[0] + BACK + start
        rng = self._rng(part)
        x = with_new_stretch(self.observation.unknowns, answer, rng)
        return self._cached(part, partial(self._foretell, x, rng))[0]

    def _explain(
        self, lines: int, x: FloatArray, rng: np.random.Generator
    ) -> tuple[FloatArray, bool]:
        """Take steps with draws of so many lines until they explain one; whether they do."""
        for _ in range(DRAWS):
            part = self._draw(lines, rng)
            x = self._better(part, x, None)
            if is_noise(_excess(part, x)):
                return x, True
        return x, False

    def _foretell(self, x: FloatArray, rng: np.random.Generator) -> tuple[FloatArray, bool]:
        """Take steps with draws of all lines until some need none; whether they do."""
        in_a_row, foretold = FORETOLD
        left = in_a_row
        for _ in range(DRAWS):
            part = self._draw(FEW[0], rng)
            if _excess(part, x) > foretold:
                left = in_a_row
                x = self._better(part, x, None)
                continue
            left -= 1
            if left == 0:
                return x, True
        return x, False

    def _draw(self, lines: int, rng: np.random.Generator) -> Observation:
        return self.observation.on_random_points(lines / FEW[0], (lines, *FEW[1:]), rng)

    def _cached(
        self, part: int, find: Callable[[], tuple[FloatArray, bool]]
    ) -> tuple[FloatArray, bool]:
        """Return what explains a part, and whether it does, from the file or found now."""

        def calculate() -> dict[str, Any]:
            x, explains = find()
            return {"x": x.tolist(), "explains": explains}

        found = self.cache(f"down.{self.number}.{part}", calculate)
        return np.array(found["x"]), found["explains"]

    def _better(self, part: Observation, x: FloatArray, name: str | None) -> FloatArray:
        full = None if name is None else f"down.{self.number}.{name}"
        return self.steps(part, x, self.number, full, (), "better").mean

    def _rng(self, *part: int) -> np.random.Generator:
        return np.random.default_rng([self.seed, 2**31 + 3, self.number, *part])


def _excess(observation: Observation, x: FloatArray) -> float:
    """Return (χ² − its mean) / its standard deviation at x (unknown,)."""
    return chi_square_excess(observation, observation.simulate(x[None])[0])


def with_new_stretch(unknowns: Unknowns, answer: Gaussian, rng: np.random.Generator) -> FloatArray:
    """Return unknowns (unknown,) of which V is drawn anew about one site.

    It is there the more often, the larger the error bar is. Both the old V and the new one are as
    probable as the disorder model has it.
    """
    x, std = answer.mean, unknowns.potential_std(answer.covariance)
    old, drawn = unknowns.potential(x), unknowns.potential(unknowns.prior.draw(rng, 2)[0])
    site, width, new = (
        rng.choice(old.size, p=std / std.sum()),
        rng.uniform(*STRETCH),
        rng.choice(DRAWN_ANEW),
    )
    window = np.exp(-(((np.arange(old.size) - site) / width) ** 2) / 2)
    share = new * window
    return unknowns.with_potential(x, np.sqrt(1 - share**2) * old + share * drawn)
