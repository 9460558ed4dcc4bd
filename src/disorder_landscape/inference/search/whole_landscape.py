"""The optima of the whole landscape: V of every site, of which only the disorder model is known.

No guess is near enough for Gauss–Newton steps with all data. But the higher μ is, the less V
scatters the electrons back, and the wider the minima of −2 log of the posterior density are. So
steps take the lines of the highest μ first, and add lower ones as they go on. The lower lines then
see a potential that is nearly right where it matters to them.

They end near the best optimum, but often in another one some 10 µeV away, which fits all but as
well. From starts about that one, as far off again, steps reach the best one.
"""

from __future__ import annotations

import numpy as np

from disorder_landscape.inference.optimum import Optimum, best
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.optima import Optima, Steps

HIGHEST = 1 / 12, 1 / 5, 3 / 8, 3 / 5, 5 / 6
"""Of the lines of μ, from the highest down, that steps use one after the other before they use
all."""
WAYS_DOWN = 3
"""At most. The first is from the middle of the prior, the others from draws."""
STARTS = 4, 8
"""On each way so many starts, its own end the first, if none leads to an optimum that fits, or if
one does. The others are near the best optimum of the way, and use the last of these parts of the
data before all. …"""
NEAR_BEST = 0.2
"""… Near is this part of the prior's width. (From 0.1 and 0.2, and from 4 and 8 error bars away,
five of five such starts left an optimum that was 13 µeV off for one that was 3 µeV off.)"""


def optima_of_whole_landscape(
    observation: Observation, steps: Steps, seed: int
) -> tuple[Optima, int]:
    """Return the optima to which steps over lower and lower μ lead, and how many ways down."""
    parts = observation.on_highest_lines(HIGHEST)
    optima = Optima(observation, parts[-1], steps)
    prior, rng = observation.unknowns.prior, np.random.default_rng([seed, 2**31 + 3])
    few, more = STARTS
    for way in range(WAYS_DOWN):
        x = prior.mean if way == 0 else prior.draw(rng, 2)[0]
        of_way: list[Optimum] = []
        while not optima.is_done and len(of_way) < (more if optima.fits else few):
            for k, part in enumerate([optima.some] if of_way else parts):
                x = steps(part, x, way, f"{way}.{len(of_way)}.highest.{k}", (), "fit").mean
            of_way.append(optima.end_at(x, way, "place"))
            near = Gaussian(best(of_way).answer.mean, NEAR_BEST**2 * prior.covariance)
            x = near.draw(rng, 2)[0]
        if optima.is_done:
            break
    if optima.fits:
        optima.refine(way)
    return optima, way + 1
