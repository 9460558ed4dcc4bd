"""What whoever waits for an inversion sees."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from tqdm import tqdm

from disorder_landscape.inference.inversion import Told
from disorder_landscape.inference.rounds import Round

USUAL_ROUNDS = 4
"""Rounds that most attempts from a guess take: what the time left is estimated from."""


@contextmanager
def inference_progress() -> Iterator[Told]:
    """Give a progress bar of one inversion, to be told of every round."""
    with tqdm(total=USUAL_ROUNDS, unit=" rounds", desc="infer", delay=1) as bar:

        def told(attempt: int, number: int, one: Round) -> None:
            bar.total = bar.n + max(USUAL_ROUNDS - number, 2)
            spread = f"spread {1e3 * one.spread:.3g} µeV"
            bar.set_postfix_str(f"attempt {attempt + 1}, misfit {one.misfit:.5f} e²/h, {spread}")
            bar.update()

        yield told
        bar.total = bar.n
