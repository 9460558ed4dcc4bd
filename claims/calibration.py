"""Whether the error bars of the inversions mean what they say: simulation-based calibration.

If they do, the truth's quantiles in the answers are uniform over [0, 1] (Talts et al.,
arXiv:1804.06788; Säilynoja, Bürkner and Vehtari, Stat. Comput. 32, 32 (2022)). For
some wires the answer is compared with a Markov chain of the exact posterior, too.
Reads inversions.csv; writes calibration.json and calibration.png.
"""

from __future__ import annotations

import argparse
import hashlib
import warnings
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.stats import kstest, norm, uniform
from tqdm import tqdm

from disorder_landscape.chain import MODELS
from disorder_landscape.claims.inversions import (
    COVERAGE,
    INVERSIONS,
    coverage,
    joint_coverage,
    joint_quantiles,
    z_scores,
)
from disorder_landscape.dataset.store import provenance
from disorder_landscape.files import read_json, replacing, write_json
from disorder_landscape.inference.attempt import best
from disorder_landscape.inference.invert import invert
from disorder_landscape.inference.posterior.markov_chain import independence_chain
from disorder_landscape.studies.inversions import Task, fresh_wire, network_of

NOISE = 0.01
"""Of the wires for which there is a chain, in e²/h."""
LENGTH = 256
"""Of the chains."""


def calibration(table: pd.DataFrame) -> dict[str, object]:
    """Return coverage, and the p-value that the quantiles are uniform, for each model and noise.

    Of each unknown alone, and of all at once.
    """
    found: dict[str, object] = {}
    for (model, noise), some in table[table["noise"] > 0].groupby(["model", "noise"]):
        one: dict[str, object] = {"wires": len(some)}
        for which, quantiles, parts in (
            ("", norm.cdf(z_scores(some)), coverage(some)),
            ("joint_", joint_quantiles(some), joint_coverage(some)),
        ):
            inside = dict(zip(map(str, COVERAGE), parts.round(4).tolist(), strict=True))
            one[f"{which}p"] = round(float(kstest(quantiles, "uniform").pvalue), 4)
            one[f"{which}inside"] = inside
        found[f"{model}, {noise:g}"] = one
    return found


def chains(model: str, wires: int) -> list[dict[str, float]]:
    """Compare answers with chains: acceptance, difference of means, ratio of their widths."""
    rows = []
    for index in tqdm(range(wires), unit=" chains", desc=model):
        task = Task(model, NOISE, index)
        observation, _ = fresh_wire(task)
        answer = best(invert(observation, network_of(model, NOISE), seed=index)).answer
        chain = independence_chain(observation, answer, LENGTH, np.random.default_rng(index))
        scale = np.sqrt(np.diag(answer.covariance))
        rows.append(
            {
                "acceptance": round(chain.acceptance, 3),
                "apart_in_stds": round(
                    float((abs(chain.samples.mean(0) - answer.mean) / scale).max()), 3
                ),
                "ratio_of_stds": round(float((chain.samples.std(0) / scale).mean()), 3),
            }
        )
    return rows


def draw(table: pd.DataFrame, path: Path) -> None:
    """Draw how far the quantiles' distribution is from uniform, with ArviZ's 95 % bands."""
    import matplotlib as mpl

    mpl.use("Agg")
    with warnings.catch_warnings():
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
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=200)


def main() -> None:
    """Calculate, draw and write."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    folder = Path(__file__).resolve().parent
    parser.add_argument("-o", "--output", type=Path, default=folder / "calibration.json")
    parser.add_argument(
        "--chains", type=int, default=10, help="wires with a chain, per model; 0 keeps those stored"
    )
    parser.add_argument("--models", nargs="*", choices=MODELS, default=list(MODELS))
    arguments = parser.parse_args()

    table = pd.read_csv(INVERSIONS)
    draw(table, arguments.output.with_suffix(".png"))
    made = {
        **provenance("python claims/calibration.py"),
        "inversions": hashlib.sha256(INVERSIONS.read_bytes()).hexdigest(),
    }
    result = {"provenance": made, "calibration": calibration(table)}
    if arguments.chains or not arguments.output.exists():
        result["chains"] = {model: chains(model, arguments.chains) for model in arguments.models}
    else:
        result["chains"] = read_json(arguments.output, "output", "be of an earlier run")["chains"]
    write_json(arguments.output, result)


if __name__ == "__main__":
    main()
