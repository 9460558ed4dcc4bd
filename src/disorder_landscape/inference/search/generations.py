"""What generations of a population are made of: other parts, the steps that follow, who stays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from disorder_landscape.inference.problem.observation import (
    Observation,
    overall_misfit,
    squared_misfits,
)
from disorder_landscape.inference.search.gauss_newton import Goal
from disorder_landscape.inference.search.parts import (
    Cut,
    exchanged,
    moved,
    redrawn,
    with_another_part,
)
from disorder_landscape.inference.search.small_steps import SmallSteps
from disorder_landscape.inference.search.steps import Steps
from disorder_landscape.inference.search.wires import Wire, best_of, objective_of, that_stay
from disorder_landscape.inference.stages import SMALL_STEPS, within
from disorder_landscape.model.parameters import FloatArray

DRAWS = 12, 300
"""Draws of the prior that a population begins with, and small steps from each."""
CHILDREN = (exchanged, 3), (moved, 5), (redrawn, 2)
"""So many wires of a generation get another part of each kind. Steps go on with the best of each
kind. (The best ones of all kinds would be those that have changed least: after 100 steps wires of
which a part has moved to where it is right have up to nine times the χ² of before.)"""
SMALL = 100, 300, 200
"""Small steps of each of them; of the best ones then; and of these, when nothing is held any more.
"""
FAR = Cut(
    redrawn=(1 / 30, 1 / 2),
    taken=(1 / 15, 2 / 3),
    seam=(1 / 60, 1 / 10),
    held=0.5,
)
NEAR = Cut(
    redrawn=(1 / 30, 1 / 5),
    taken=(1 / 15, 2 / 3),
    seam=(1 / 100, 1 / 100),
    held=0.1,
)
NEAR_CHILDREN, GO_ON = ((exchanged, 6), (redrawn, 2)), 3
"""The same where few Gauss–Newton steps follow at once; with so many of the best they go on."""
COME_NEAR = 3.0
"""Gauss–Newton steps follow at first from the best wire, and from others whose mean square misfit
is less, in units of the noise's."""
APART_FAR, APART_NEAR = 0.25, 0.12
"""Of wires whose V differs by less, in standard deviations of the prior, root mean square over the
sites, only the best one stays."""
LEAVE = 300
"""Small steps that leave an optimum, towards others near it."""


@dataclass(eq=False)
class Generations:
    """The wires that follow those of a generation.

    Parameters
    ----------
    observation : Observation
    few, more : Observation
        The data by which wires are compared far from the true V, and near it.
    steps : Steps
    number : int
        Of the population, to tell of it.
    """

    observation: Observation
    few: Observation
    more: Observation
    steps: Steps
    number: int
    reports: int = 0
    """How often whom it tells has been told."""
    spread: float = 0.0
    """What it tells: the standard deviation of V among the wires in meV, as `Step.spread`."""

    def drawn(self, rng: np.random.Generator) -> list[Wire]:
        """Return wires to which small steps lead from draws of the prior."""
        count, steps = DRAWS
        prior, wires = self.observation.unknowns.white_noise, []
        for x in prior.draw_apart(rng, count):
            small = SmallSteps(self.observation, prior, x)
            wires.append(self._after(small, steps, rng))
        return self.that_stay_far(wires)

    def by_small_steps(self, wires: Sequence[Wire], rng: np.random.Generator) -> list[Wire]:
        """Let small steps follow other parts."""
        return self.that_stay_far([*wires, *self._small_steps(wires, rng)])

    def come_near(self, wires: Sequence[Wire]) -> list[Wire]:
        """Let Gauss–Newton steps follow."""
        best = best_of(wires)
        near = [one for one in wires if one is best or self.misfit(one) < COME_NEAR]
        return self._that_stay_near([self._ended(one.x, "better") for one in near])

    def near_by_small_steps(self, wires: Sequence[Wire], rng: np.random.Generator) -> list[Wire]:
        """Let small steps and then Gauss–Newton steps follow other parts."""
        children = [self._ended(one.x, "better") for one in self._small_steps(wires, rng)]
        return self._that_stay_near([*wires, *children])

    def near_by_exchange(self, wires: Sequence[Wire], rng: np.random.Generator) -> list[Wire]:
        """Let Gauss–Newton steps follow other parts."""
        unknowns = self.observation.unknowns
        starts = [
            with_another_part(kind, unknowns, wires, NEAR, rng).x
            for kind, count in NEAR_CHILDREN
            for _ in range(count)
        ]
        tried = sorted([self._ended(x, "few") for x in starts], key=objective_of)
        children = [self._ended(one.x, "better") for one in tried[:GO_ON]]
        return self._that_stay_near([*wires, *children])

    def left(self, x: FloatArray, rng: np.random.Generator) -> list[Wire]:
        """Leave an optimum at x (unknown,) by small steps."""
        small = SmallSteps(self.observation, self.observation.unknowns.white_noise, x)
        return [self._after(small, LEAVE, rng)]

    def misfit(self, wire: Wire) -> float:
        """Return the mean square misfit far from the true V in units of the noise's."""
        return float(squared_misfits(self.few, wire.data).mean())

    def that_stay_far(self, wires: Sequence[Wire]) -> list[Wire]:
        """Return which of wires stay, far from the true V."""
        return that_stay(self.observation.unknowns, wires, APART_FAR)

    def _that_stay_near(self, wires: Sequence[Wire]) -> list[Wire]:
        return that_stay(self.observation.unknowns, wires, APART_NEAR)

    def _small_steps(self, wires: Sequence[Wire], rng: np.random.Generator) -> list[Wire]:
        """Return the wires to which small steps lead from other parts: the best of each kind."""
        unknowns = self.observation.unknowns
        first, held, free = SMALL
        children = list[Wire]()
        for kind, count in CHILDREN:
            tried = []
            for _ in range(count):
                start = with_another_part(kind, unknowns, wires, FAR, rng)
                small = SmallSteps(self.observation, start.prior, start.x)
                tried.append((self._after(small, first, rng).objective, small))
            _, best = min(tried, key=lambda one: one[0])
            self._after(best, held, rng)
            best.prior = unknowns.white_noise
            children.append(self._after(best, free, rng))
        return children

    def _after(self, small: SmallSteps, count: int, rng: np.random.Generator) -> Wire:
        """Return the wire after so many more small steps."""
        small.take(count, rng)
        wire = Wire.at(self.few, small.x)
        report = within(self.steps.progress, self.number, SMALL_STEPS)
        report(self.reports, overall_misfit(self.few, wire.data), self.spread)
        self.reports += 1
        return wire

    def _ended(self, x: FloatArray, goal: Goal) -> Wire:
        """Return the wire where Gauss–Newton steps end."""
        return Wire.at(self.more, self.steps.end(self.more, x, self.number, goal=goal).mean)
