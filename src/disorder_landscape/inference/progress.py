"""What whoever waits for an inversion sees."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from tqdm import tqdm

from disorder_landscape.inference.invert import Step, Told

USUAL_STEPS = {"round": 4, "polish": 3, "population": 4}
"""How many most attempts from a guess take, of about one length: what the time left is estimated
from."""


@contextmanager
def inference_progress() -> Iterator[Told]:
    """Give a progress bar of one inversion, to be told of every step."""
    with tqdm(total=sum(USUAL_STEPS.values()), unit=" steps", desc="infer", delay=1) as bar:

        def told(step: Step) -> None:
            left = max(USUAL_STEPS[step.stage] - step.number, 2)
            bar.total = bar.n + left + (USUAL_STEPS["polish"] if step.stage == "round" else 0)
            bar.set_postfix_str(
                f"attempt {step.attempt + 1}, {step.stage} {step.number + 1}, "
                f"misfit {step.misfit:.5f} e²/h, spread {1e3 * step.spread:.3g} µeV"
            )
            bar.update()

        yield told
        bar.total = bar.n
