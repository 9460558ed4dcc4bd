"""The optima of the posterior to which Gauss–Newton steps lead from many starts.

The conductances are peaks of a few kT, so that −2 log of the posterior density has many minima.
From a network's guess or a distribution of the rounds some starts lead to the best of them: nearly
all from 5 to 30 µeV off, a quarter to a half from 100 µeV off. One start alone may end in a minimum
beside the best one that fits all but as well. Starts that agree tell; and where the noise leaves
several minima that are about as probable, these are all looked for, until each has been found more
than once.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from disorder_landscape.inference.optimum import (
    NEGLIGIBLE,
    Optimum,
    add,
    best,
    chi_square_excess,
    is_noise,
    optimum_at,
    same_answer,
    shares,
    unseen,
)
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.gauss_newton import Goal, is_near
from disorder_landscape.inference.search.steps import Steps
from disorder_landscape.inference.verdict import UNSEEN, is_surely_right
from disorder_landscape.model.parameters import FloatArray

AGREEING = 2, 3
"""How many starts must lead to the best optimum: where the noise is so small that an answer that
fits is right all but surely, and otherwise. (Of thirteen such wires without noise, one start ended
4 µeV off and fitted.)"""
WIDE = 4.3e-3
"""The posterior may have several maxima if the noise may hide them and V is uncertain by more than
this in meV, whatever kT is: conductances are as straight across it at 300 mK as at 50. …"""
SEVERAL = 0.1
"""… So may it if optima beside the best one hold more than this share of it. …"""
STARTS_WHEN_WIDE = 16, 64
"""… Then there are at least, and at most, so many starts. (Of nineteen wires of ten components at
0.1 e²/h eleven converge with 32 starts and ten iterations of importance sampling, and sixteen with
64 and 16.)"""


@dataclass(eq=False)
class Optima:
    """What starts have led to so far.

    Parameters
    ----------
    observation : Observation
    steps : Steps
    when_wide : pair of int
        How many starts there are at least and at most where the posterior may have several maxima.
    """

    observation: Observation
    steps: Steps
    when_wide: tuple[int, int] = STARTS_WHEN_WIDE
    found: list[Optimum] = field(default_factory=list)
    starts: int = 0

    @property
    def fits(self) -> bool:
        """Whether the best of them explains the data."""
        return bool(self.found) and best(self.found).fits

    @property
    def is_wide(self) -> bool:
        """Whether the best optimum explains the data, but others may do so, too."""
        if not self.fits or is_surely_right(self.observation):
            return False
        bar = self.observation.unknowns.site_std(best(self.found).answer.covariance)
        beside = 1 - shares(self.found)[self.found.index(best(self.found))]
        return bar > WIDE or bool(beside > SEVERAL)

    @property
    def is_settled(self) -> bool:
        """Whether more starts are not expected to change anything."""
        if not self.fits:
            return False
        needed = AGREEING[0 if is_surely_right(self.observation) else 1]
        enough = not self.is_wide or self.starts >= self.when_wide[0]
        agreed = len(best(self.found).found_by) >= needed
        return enough and agreed and unseen(self.found, shares(self.found)) <= UNSEEN

    @property
    def is_exhausted(self) -> bool:
        """Whether there have been as many starts as are worth their time."""
        return self.is_wide and self.starts >= self.when_wide[1]

    @property
    def is_done(self) -> bool:
        """Whether no more starts are needed, or worth their time."""
        return self.is_settled or self.is_exhausted

    def count_start(self, attempt: int) -> str:
        """Count a start, and return its name."""
        self.starts += 1
        return f"{attempt}.{self.starts - 1}"

    def start_at(self, x: FloatArray, attempt: int, goal: Goal = "optimum") -> None:
        """Find the optimum that steps from x (unknown,) with all data lead to."""
        self.end_at(x, attempt, self.count_start(attempt), goal)

    def end_at(self, x: FloatArray, attempt: int, name: str, goal: Goal) -> int:
        """Do so for a start that has been counted, and return which of those found it is."""
        end = self.steps.end(self.observation, x, attempt, name, self.found, goal)
        return add(self.observation, self.found, optimum_at(self.observation, end, (attempt,)))

    def of(self, observation: Observation) -> Optima:
        """Return the optima of more data, to which steps from these lead where they have a share.

        Where the best of them does not explain the data, none has.
        """
        if observation is self.observation:
            return self
        share, found = shares(self.found), list[Optimum]()
        for k, one in enumerate(self.found):
            answer = one.answer
            if self.fits and share[k] > NEGLIGIBLE:
                answer = self.steps.end(observation, answer.mean, one.found_by[0], f"all.{k}")
            add(observation, found, optimum_at(observation, answer, one.found_by))
        return replace(self, observation=observation, found=found)

    def look_at_mirror_images(self, attempt: int) -> None:
        """Add the optima at mirror images of those that have a share, if they explain the data too.

        Data may be those of both, as nonlocal conductances without a bias are, and no start need
        come near an image. It is found by as many starts as its original is.
        """
        if not self.fits:
            return
        observation, share = self.observation, shares(self.found)
        for k, one in enumerate(list(self.found)):
            x = observation.unknowns.mirrored(one.answer.mean)
            if share[k] < NEGLIGIBLE or any(is_near(other, x) for other in self.found):
                continue
            if not is_noise(chi_square_excess(observation, observation.simulate(x[None])[0])):
                continue
            end = self.steps.end(observation, x, attempt, f"{self.starts}.mirror.{k}")
            image = optimum_at(observation, end, one.found_by)
            if not any(same_answer(observation, other, image) for other in self.found):
                self.found.append(image)

    def found_again(self, k: int, attempt: int) -> None:
        """Note that another start leads to this one of those found."""
        one = self.found[k]
        self.found[k] = replace(one, found_by=(*one.found_by, attempt))
