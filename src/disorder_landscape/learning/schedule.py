"""The epochs of a training and their learning rates."""

from __future__ import annotations

import math

from disorder_landscape.config import TrainingConfig

RISE_FROM = 0.01
"""Share of the learning rate with which the rise of the cosine schedule begins."""


def numbered_epochs(training: TrainingConfig) -> list[tuple[int, int]]:
    """Return epoch and set, both from 1, of every epoch (S-II.2)."""
    sets = [i + 1 for i, epochs in enumerate(training.epochs) for _ in range(epochs)]
    return list(enumerate(sets, start=1))


def learning_rate(training: TrainingConfig, epoch: int, share: float = 0.0) -> float:
    """Return the learning rate in an epoch (from 1), of which a share is done.

    Each set divides it by 10 (S-II.2); or it falls along a cosine to zero, after a linear rise over
    the first epoch (Loshchilov and Hutter, ICLR 2017; Goyal et al., arXiv:1706.02677).
    """
    if training.schedule == "sets":
        set_ = dict(numbered_epochs(training))[epoch]
        return training.learning_rate / 10.0 ** (set_ - 1)
    done = epoch - 1 + share
    if done < 1:
        return training.learning_rate * max(done, RISE_FROM)
    total = sum(training.epochs)
    falling = (done - 1) / max(total - 1, 1)
    return training.learning_rate * 0.5 * (1 + math.cos(math.pi * falling))
