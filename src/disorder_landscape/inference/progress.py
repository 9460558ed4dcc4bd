"""How long an inversion will take, and a progress bar for it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from tqdm import tqdm

from disorder_landscape.estimates import announce_repeated
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.stages import (
    GAUSS_NEWTON,
    IMPORTANCE_SAMPLING,
    MAPS,
    ROUND,
    SMALL_STEPS,
    Progress,
    Step,
)
from disorder_landscape.inference.verdict import is_surely_right

USUAL_STEPS = {ROUND: 4, SMALL_STEPS: 120, GAUSS_NEWTON: 8, IMPORTANCE_SAMPLING: 3, MAPS: 1}
"""How many most inversions take, of about one length: what the time left is estimated from."""

WIRES_PER_UNKNOWN = 12, 35, 220
"""How many times all data of a wire are simulated for each unknown: where an answer that fits is
surely right; otherwise; and from OFTEN_WIDE on. Means of inversions of 5+1 and ten components with
noise of 0.001 and of 0.01 e²/h, and of 5+1 with 0.1; single ones take a third to twice that."""
OFTEN_WIDE = 0.03
"""Noise in e²/h with which most wires' posterior may have several maxima (`Optima.is_wide`)."""
WIRES_OF_LANDSCAPE = 3000
"""The same of a whole landscape, however many unknowns it has; a quarter of that where disorder is
weak or the wire is short. (Of eight wires of the paper's disorder, single ones take 2,000 to
5,500.)"""


def announce_inference(observation: Observation) -> None:
    """Say how long an inversion will take, after simulating what is measured for a second."""
    prior = observation.unknowns.white_noise.mean
    once, twice, wide = WIRES_PER_UNKNOWN
    if observation.unknowns.is_whole_landscape:
        wires = WIRES_OF_LANDSCAPE
    elif is_surely_right(observation):
        wires = prior.size * once
    else:
        wires = prior.size * (wide if observation.noise.mean() >= OFTEN_WIDE else twice)
    announce_repeated("infer", lambda k: observation.simulate(prior[None]), wires, _say)


def _say(text: str) -> None:
    print(f"{text}; several times that where no wire explains the data")


@contextmanager
def inference_progress() -> Iterator[Progress]:
    """Show a progress bar of one inversion; give the progress callback that moves it."""
    with tqdm(total=sum(USUAL_STEPS.values()), unit=" steps", desc="infer", delay=1) as bar:

        def progress(step: Step) -> None:
            left = max(USUAL_STEPS[step.stage] - step.number, 2)
            bar.total = bar.n + left + (USUAL_STEPS[GAUSS_NEWTON] if step.stage == ROUND else 0)
            bar.set_postfix_str(
                f"attempt {step.attempt + 1}, {step.stage} {step.number + 1}, "
                f"misfit {step.misfit:.5f} e²/h, spread {1e3 * step.spread:.3g} µeV"
            )
            bar.update()

        yield progress
        bar.total = bar.n
