"""The optima of the whole landscape: V of every site, of which only the disorder model is known.

No guess is near enough for Gauss–Newton steps with all data. But the higher μ is, the less V
scatters the electrons back, and the wider the minima of −2 log of the posterior density are. So
steps take the lines of the highest μ first, and add one lower line after the other. Of each line
they take few data, since few data have fewer minima than many.

Where the noise does not explain a part of the data, V is wrong somewhere, and right or harmless
elsewhere: a stretch of it is drawn anew, and steps start again from there (basin hopping: Wales and
Doye, J. Phys. Chem. A 101, 5111 (1997)). At one end or the other V is right first, and from there
on it becomes so inwards, since electrons of low μ do not reach further.

With all data steps must go to the optimum itself: valleys bend, and steps that are content with less
end some 50 µeV away, where the noise explains the data all but as well. Starts about that optimum,
with a new stretch of V each, tell whether there is a better one.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from disorder_landscape.inference.checkpoint import Cache, cached_gaussian, uncached
from disorder_landscape.inference.optimum import best, optimum_at
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.search.optima import Optima, Steps
from disorder_landscape.model.parameters import FloatArray

FEW = 24, 5, 7
"""Points of μ, B and bias on the way down, …"""
MORE = 48, 5, 11
"""… and of the data that follow before all."""
HIGHEST = 4
"""The way down begins with so many lines of μ."""
WAYS_DOWN = 3
"""At most. The first is from the middle of the prior, the others from draws."""
REDRAWN = 40
"""A way ends where so many new stretches of V have not led to an optimum that fits a part."""
STRETCH = 8.0, 35.0
"""Standard deviation of the Gaussian window in which V is drawn anew, in sites: the least and the
largest."""
DRAWN_ANEW = 0.3, 0.45, 0.6
"""Share of the new V in the middle of the window, root mean square; what was there has the rest. (Of
160 stretches of two wires of 300 sites, with 0.3, 0.6 and 1 each, 20, 10 and 1 led to a better
optimum.)"""
STARTS = 40
"""After each way down that leads to an optimum that fits, its own end the first. The others have a
new stretch of V each. (Starts that differ everywhere, by a fifth of the prior's width, serve where
disorder is weak. Where it is strong they are too far off.)"""


def optima_of_whole_landscape(
    observation: Observation, steps: Steps, seed: int, cache: Cache = uncached
) -> tuple[Optima, int]:
    """Return the optima to which steps over lower and lower μ lead, and how many ways down."""
    optima = Optima(observation, observation.on_few_points(*MORE), steps, "better")
    few = observation.on_few_points(*FEW).on_highest_lines(HIGHEST)
    prior, rng = observation.unknowns.prior, np.random.default_rng([seed, 2**31 + 3])
    for way in range(WAYS_DOWN):
        x = prior.mean if way == 0 else prior.draw(rng, 2)[0]
        for number, part in enumerate([*few, optima.some, observation]):
            stretches = np.random.default_rng([seed, 2**31 + 3, way, number])
            make = partial(_answer_of_part, part, x, steps, way, stretches)
            answer = cached_gaussian(cache, f"part.{way}.{number}", make)
            x = answer.mean
            fits = optimum_at(part, answer).fits
            if not fits:
                break
        optima.end_at(x, way, "optimum" if fits else "place")
        until = optima.starts + STARTS - 1
        while optima.fits and not optima.is_settled and optima.starts < until:
            x = with_new_stretch(observation.unknowns, best(optima.found).answer, rng)
            optima.start_from(x, way)
        if optima.fits:
            break
    return optima, way + 1


def _answer_of_part(
    part: Observation, x: FloatArray, steps: Steps, way: int, rng: np.random.Generator
) -> Gaussian:
    """Return an optimum that explains a part of the data, or the best one if none is found to."""
    end = optimum_at(part, steps(part, x, way, None, (), "better"))
    for _ in range(REDRAWN):
        if end.fits:
            break
        x = with_new_stretch(part.unknowns, end.answer, rng)
        end = best([end, optimum_at(part, steps(part, x, way, None, [end], "better"))])
    return end.answer


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
