"""What whoever waits for an inversion sees."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from tqdm import tqdm

from disorder_landscape.inference.inversion import Told
from disorder_landscape.inference.smoother import Step

USUAL_STEPS = 7
"""Steps that most inversions from a guess take: what the time left is estimated from."""


@contextmanager
def inference_progress() -> Iterator[Told]:
    """Give a progress bar of one inversion, to be told of every step."""
    with tqdm(total=USUAL_STEPS, unit=" steps", desc="infer", delay=1) as bar:

        def told(attempt: int, number: int, step: Step) -> None:
            bar.total = bar.n + max(USUAL_STEPS - number, 2)
            spread = f"spread {1e3 * step.spread:.3g} µeV"
            bar.set_postfix_str(f"attempt {attempt + 1}, misfit {step.misfit:.5f} e²/h, {spread}")
            bar.update()

        yield told
        bar.total = bar.n
