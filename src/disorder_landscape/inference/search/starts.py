"""From a start to an optimum of few unknowns, by steps with some of the data first.

Where the noise may hide optima, and where an attempt has found none that fits, a start is the best
of many draws.
"""

from __future__ import annotations

from dataclasses import InitVar, dataclass, field

import numpy as np

from disorder_landscape.inference.optimum import Optimum, best, optimum_at
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.best_of_draws import best_of_draws
from disorder_landscape.inference.search.gauss_newton import is_near
from disorder_landscape.inference.search.optima import Optima
from disorder_landscape.inference.verdict import is_surely_right
from disorder_landscape.model.parameters import FloatArray

SHARE = 0.25
"""Of the data that steps use first, which are the same for all starts."""
FEWEST = 7
"""Lines of μ and of B that these have at least."""
STARTS = 2, 4
"""So many starts about a distribution, if none has led to an optimum that fits, or if one has."""
MORE_STARTS = 3
"""At most so many at the best of many draws, where an attempt ends without such an optimum."""
MOST_STARTS = 128
"""There are no more than this, even if samples of the posterior ask for more."""
NEARBY = 0.2
"""Where an answer that fits is right all but surely, another start must find it again from this
part of the distribution's width away."""
REACH = 30.0
"""Steps go on with all data if the optimum on these explains them, and is worse than the best one
so far by no more than this in −2 log(posterior)."""


@dataclass(eq=False)
class Starts:
    """Starts of steps, and where they have led on some of the data.

    Parameters
    ----------
    optima : Optima
        To which the optima are added.
    rng : Generator
        Which data come first.
    """

    optima: Optima
    rng: InitVar[np.random.Generator]
    some: Observation = field(init=False)
    _on_some: list[tuple[Optimum, int | None]] = field(default_factory=list)
    """Optima on these data, and which one of all data they lead to, if any."""
    _about: tuple[Gaussian, int] = field(init=False)
    """The last distribution, and in which attempt."""

    def __post_init__(self, rng: np.random.Generator) -> None:
        self.some = self.optima.observation.on_some_lines(SHARE, FEWEST, rng)

    def start_about(
        self, found: Gaussian, attempt: int, rng: np.random.Generator, tried: int = 0
    ) -> None:
        """Let steps start at the mean of a distribution, if none has been tried, and at draws."""
        self._about = found, attempt
        optima, (few, more) = self.optima, STARTS
        while not optima.is_done:
            fits, is_wide = optima.fits, optima.is_wide
            if tried >= (more if fits else few) and not is_wide:
                return
            (own,) = rng.spawn(1)
            if tried == 0:
                x = found.mean
            elif fits and is_surely_right(optima.observation):
                near = Gaussian(best(optima.found).answer.mean, NEARBY**2 * found.covariance)
                x = near.draw(own, 2)[0]
            elif is_wide:
                x = self._best_of_draws(found, own)
            else:
                x = found.draw(own, 2)[0]
            self.start_from(x, attempt)
            tried += 1

    def start_at_best_of_draws(
        self, about: Gaussian, attempt: int, rng: np.random.Generator
    ) -> None:
        """Let steps start at the best of many draws until an optimum fits, MORE_STARTS at most.

        Where one does, others follow.
        """
        for own in rng.spawn(MORE_STARTS):
            self.start_from(self._best_of_draws(about, own), attempt)
            if self.optima.fits:
                self.start_about(about, attempt, rng, tried=1)
                return

    def go_on(self, rng: np.random.Generator) -> None:
        """Let there be twice as many starts, or more, about the same distribution as the last.

        At most `MOST_STARTS` in all.
        """
        optima, (found, attempt) = self.optima, self._about
        least = min(2 * optima.starts, MOST_STARTS)
        optima.when_wide = least, max(least, optima.when_wide[1])
        self.start_about(found, attempt, rng, tried=1)

    def start_from(self, x: FloatArray, attempt: int) -> None:
        """Find the optimum that steps from x (unknown,) lead to."""
        optima, steps = self.optima, self.optima.steps
        name = optima.count_start(attempt)
        known = [one for one, _ in self._on_some]
        end = steps.end(self.some, x, attempt, f"{name}.some", known, "place")
        for one, leads_to in self._on_some:
            if is_near(one, end.mean):
                if leads_to is not None:
                    optima.found_again(leads_to, attempt)
                return
        near = optimum_at(self.some, end)
        least = best([*known, near]).objective
        goes_on = near.fits and near.objective <= least + REACH
        leads_to = optima.end_at(end.mean, attempt, name, "optimum") if goes_on else None
        self._on_some.append((near, leads_to))

    def _best_of_draws(self, about: Gaussian, rng: np.random.Generator) -> FloatArray:
        def make() -> dict[str, list[float]]:
            return {"x": best_of_draws(self.optima.observation, about, rng).tolist()}

        return np.array(self.optima.steps.cache(f"start.{self.optima.starts}", make)["x"])
