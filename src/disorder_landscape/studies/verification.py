"""Whether measurements that the network never saw tell a right prediction from a wrong one.

Each of the shipped 5+1 network's 200 test wires is measured at settings between and beyond those of
the training: other μ, B and biases with both barriers changed, and with the field at an angle θ to
the wire. `verify` then compares its prediction, and 19 wires with wrong disorder, with these
measurements. A prediction is told apart if it fits better than each of the 19.

Writes verification.json: the share of wires that are told apart, and each wire's score and the
smallest of its 19.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from tqdm import tqdm

from disorder_landscape import Nanowire, conductance, predict, verify
from disorder_landscape.chain import FIVE, SHIPPED, preset_run, read_test_set
from disorder_landscape.config import DatasetConfig
from disorder_landscape.dataset.store import provenance
from disorder_landscape.files import write_json
from disorder_landscape.model.disorder import MEAN_STD

MU = np.array([0.13, 0.4])
"""In meV, between the points of the network's grid."""
B = np.array([0.33, 0.5, 0.69])
"""In T."""
BIAS = np.array([-0.03, 0.01])
"""In meV."""
BARRIERS = (25.0, 10.0)
"""Left and right, in meV; 15 in the training."""
ANGLE = np.pi / 6
CONTROLS = 19
SHIFTS = 3 * MEAN_STD * np.linspace(-1, 1, 7)


class Verified(NamedTuple):
    """Scores of the prediction of one wire, and of the best of those with wrong disorder."""

    score: float
    best_wrong: float


def verified(task: tuple[xr.Dataset, xr.Dataset, DatasetConfig]) -> Verified:
    """Measure one test wire, and verify its prediction."""
    test, prediction, config = task
    wire = Nanowire(test["potential"].to_numpy(), alpha=float(test["alpha"]))
    measurements = [
        conductance(replace(wire, barrier=BARRIERS), MU, B, BIAS, config.temperature),
        conductance(wire, MU[:1], B[1:], BIAS, config.temperature, theta=ANGLE),
    ]
    result = verify(prediction, measurements, controls=CONTROLS, config=config, shifts=SHIFTS)
    return Verified(float(result["score"]), float(result["control_score"].min()))


def main() -> None:
    """Verify all test wires and write the file."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    folder = Path(__file__).resolve().parent
    parser.add_argument("-o", "--output", type=Path, default=folder / "verification.json")
    parser.add_argument("--wires", type=int, default=None, help="the first ones only")
    parser.add_argument("--workers", type=int, default=2, help="processes (default: 2)")
    arguments = parser.parse_args()

    run = preset_run(SHIPPED, model=FIVE)
    config = run.config.dataset
    test = read_test_set(run).isel(realization=slice(arguments.wires))
    predictions = predict(run.model_folder, test)
    tasks = [
        (test.isel(realization=i), predictions.isel(realization=i), config)
        for i in range(test.sizes["realization"])
    ]
    # TensorFlow's threads do not survive a fork
    with ProcessPoolExecutor(arguments.workers, get_context("spawn")) as pool:
        results = list(tqdm(pool.map(verified, tasks), total=len(tasks), unit=" wires"))
    told_apart = [one.score < one.best_wrong for one in results]
    share = float(np.mean(told_apart))
    content = {
        "share_told_apart": share,
        "wires": len(results),
        "controls": CONTROLS,
        "median_score": float(np.median([one.score for one in results])),
        "provenance": provenance("python results/verification.py"),
        "verified": [one._asdict() for one in results],
    }
    write_json(arguments.output, content)
    print(
        f"{share:.1%} of {len(results)} predictions fit better than each of {CONTROLS} wrong wires"
    )


if __name__ == "__main__":
    main()
