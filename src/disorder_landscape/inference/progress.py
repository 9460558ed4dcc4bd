"""A progress bar for an inversion."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from tqdm import tqdm

from disorder_landscape.inference.invert import (
    GAUSS_NEWTON,
    IMPORTANCE_SAMPLING,
    ROUND,
    Progress,
    Step,
)

USUAL_STEPS = {ROUND: 4, GAUSS_NEWTON: 3, IMPORTANCE_SAMPLING: 4}
"""How many most attempts from a guess take, of about one length: what the time left is estimated
from."""


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
