"""Kind "calibration": whether the error bars of the inversions mean what they say.

If they do, the truth's quantiles in the answers are uniform over [0, 1] (Talts et al.,
arXiv:1804.06788; Säilynoja, Bürkner and Vehtari, Stat. Comput. 32, 32 (2022)): so it is judged from
the table of the inversions, in the same folder. For some wires the answer is compared with a Markov
chain of the exact posterior, too; they are the rows.
"""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np
import pandas as pd
from scipy.stats import kstest, norm, uniform

from disorder_landscape.arguments import require
from disorder_landscape.config import Positive
from disorder_landscape.inference.invert import invert
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.parts import needs
from disorder_landscape.pictures import write_picture
from disorder_landscape.studies import fresh_wires
from disorder_landscape.studies.fresh_wires import Noise, ShippedModel, fresh_wire, network_of
from disorder_landscape.studies.markov_chain import independence_chain
from disorder_landscape.studies.rows import Row
from disorder_landscape.studies.study import Derived, Place, Plan

COVERAGE = (0.5, 0.8, 0.95)
INVERSIONS = "inversions.csv"
"""The table that is judged."""


@dataclass(frozen=True, order=True)
class Task:
    """One chain: a shipped model's name and the index of a fresh wire."""

    model: str
    index: int


class CalibrationPlan(Plan):
    """Chains of exact posteriors, and the quantiles of the inversions."""

    kind: Literal["calibration"]
    models: tuple[ShippedModel, ...]
    noise: Noise
    """Of the wires for which there is a chain, in e²/h."""
    wires: Positive
    """Of each model."""
    length: Positive
    """Of the chains."""

    keys: ClassVar = ("model", "index")
    common: ClassVar = ("noise", "length")

    def tasks(self) -> Sequence[Task]:
        """Return the chains, by model and index."""
        return sorted(Task(model, index) for model in self.models for index in range(self.wires))

    def rows(self, task: Task, place: Place) -> list[dict[str, object]]:
        """Compare an answer with a chain.

        Returns
        -------
        list of dict
            The part of the proposals that is accepted, the largest distance of the means in
            standard deviations, and the mean ratio of the standard deviations.
        """
        observation, _ = fresh_wire(fresh_wires.Task(task.model, self.noise, task.index))
        network = network_of(task.model, self.noise)
        answer = invert(observation, network, seed=task.index).answer
        rng = np.random.default_rng(task.index)
        chain = independence_chain(observation, answer, self.length, rng)
        scale = np.sqrt(np.diag(answer.covariance))
        apart = float((abs(chain.samples.mean(0) - answer.mean) / scale).max())
        return [
            {
                "model": task.model,
                "index": task.index,
                "acceptance": round(chain.acceptance, 3),
                "apart_in_stds": round(apart, 3),
                "ratio_of_stds": round(float((chain.samples.std(0) / scale).mean()), 3),
            }
        ]

    def derived(self, rows: Sequence[Row], place: Place) -> Derived:
        """Return coverage and p-values of the inversions, and draw their quantiles."""
        path = place.output / INVERSIONS
        must = "hold the table of the inversions (landscape study inversions)"
        require(path.exists(), "output", must, f"there is no '{path}'")
        table = pd.read_csv(path)
        judged = hashlib.sha256(path.read_bytes()).hexdigest()
        numbers = {"inversions_sha256": judged, "calibration": calibration(table)}
        return Derived(numbers, draw=partial(draw, table))


def z_scores(table: pd.DataFrame) -> FloatArray:
    """Return those of the truths in the answers, of all unknowns (`Outcome.z_scores`)."""
    return np.concatenate([np.array(text.split(), dtype=float) for text in table["z_scores"]])


def more_probable(table: pd.DataFrame) -> FloatArray:
    """Return how much of each posterior is more probable than its truth, if its samples tell."""
    return np.asarray(table["more_probable"].dropna())


def coverage(table: pd.DataFrame) -> FloatArray:
    """Return which part of the truths the central intervals of COVERAGE hold."""
    z = abs(z_scores(table))
    return np.array([(z < norm.ppf((1 + part) / 2)).mean() for part in COVERAGE])


def joint_coverage(table: pd.DataFrame) -> FloatArray:
    """Return which part of the truths the most probable COVERAGE of the posteriors hold."""
    quantiles = more_probable(table)
    return np.array([(quantiles < part).mean() for part in COVERAGE])


def calibration(table: pd.DataFrame) -> dict[str, object]:
    """Return coverage, and the p-value that the quantiles are uniform, for each model and noise.

    Of each unknown alone, and of all at once.
    """
    found: dict[str, object] = {}
    for (model, noise), some in table[table["noise"] > 0].groupby(["model", "noise"]):
        one: dict[str, object] = {"wires": len(some)}
        for which, quantiles, parts in (
            ("", norm.cdf(z_scores(some)), coverage(some)),
            ("joint_", more_probable(some), joint_coverage(some)),
        ):
            inside = dict(zip(map(str, COVERAGE), parts.round(4).tolist(), strict=True))
            one[f"{which}p"] = round(float(kstest(quantiles, "uniform").pvalue), 4)
            one[f"{which}inside"] = inside
        found[f"{model}, {noise:g}"] = one
    return found


def draw(table: pd.DataFrame, path: Path) -> None:
    """Draw how far the quantiles' distribution is from uniform, with ArviZ's 95 % bands."""
    import matplotlib as mpl

    mpl.use("Agg")
    with needs("dev"), warnings.catch_warnings():
        warnings.simplefilter("ignore", FutureWarning)  # of ArviZ, about its next version
        import arviz as az
    from matplotlib import pyplot as plt

    some = table[table["noise"] > 0]
    models, noises = list(some["model"].unique()), sorted(some["noise"].unique())
    figure, panels = plt.subplots(
        len(models), len(noises), figsize=(7.06, 1.75 * len(models)), sharex=True, sharey=True,
        layout="constrained", squeeze=False,
    )  # fmt: skip
    for (row, model), (column, noise) in product(enumerate(models), enumerate(noises)):
        panel = panels[row, column]
        wires = some[(some["model"] == model) & (some["noise"] == noise)]
        panel.set_title(
            f"{model.split('_')[0]} components, {noise:g} $e^2/h$\n{len(wires)} wires", fontsize=8
        )
        if not wires.empty:
            az.plot_ecdf(
                norm.cdf(z_scores(wires)), cdf=uniform.cdf, difference=True,
                confidence_bands="auto", ci_prob=0.95, ax=panel,
                eval_points=np.linspace(0, 1, 101),
            )  # fmt: skip
        panel.tick_params(labelsize=8)
    figure.supxlabel("quantile of the truth in the answer", fontsize=8)
    figure.supylabel("ECDF − uniform", fontsize=8)
    write_picture(path, figure, dpi=200)
