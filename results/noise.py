"""R² of the 5+1 model when the conductances have errors, by both readings of the paper's sentence.

"clean": only the test wires have them (the network is trained with the experiment's 0.001 e²/h);
"noisy": the training wires too, of the same size (configs/studies/noisy_training.toml), and there
on all conductances. All test wires of the paper's 8,000, with errors on all, on the local or on the
nonlocal conductances.

Writes noise.csv, and noise.json with what made it. Trainings that build/models holds are not
repeated; interrupted ones go on.
"""

from __future__ import annotations

import argparse
import hashlib
from pathlib import Path

import pandas as pd
import xarray as xr

from disorder_landscape.chain import REPOSITORY, Run, read_test_set
from disorder_landscape.dataset.store import provenance
from disorder_landscape.files import replacing, write_json
from disorder_landscape.learning.model import load_model
from disorder_landscape.studies.noise import r2_with_errors
from disorder_landscape.studies.plan import PlannedRun, load_study
from disorder_landscape.studies.runner import carry_out, model_folder

STUDIES = REPOSITORY / "configs" / "studies"
CLEAN = "residual"
"""The run of recipes.toml that is trained like the noisy ones, but with the experiment's errors."""


def rows(run: PlannedRun, build: Path, wires: xr.Dataset, training: str) -> pd.DataFrame:
    """Return R² of one training over the errors of the test wires."""
    noise = run.config.training.noise
    R2 = r2_with_errors(load_model(model_folder(run, build)), wires)
    table = R2.round(4).to_dataframe().reset_index()
    table.insert(0, "training", training)
    table.insert(1, "training_noise", noise)
    if training == "noisy":  # as the test wires, not less and not more
        table = table[table["noise"] == noise]
    return table


def main() -> None:
    """Train what is missing and write the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    folder = Path(__file__).resolve().parent
    parser.add_argument("-o", "--output", type=Path, default=folder / "noise.csv")
    parser.add_argument("--build", type=Path, default=REPOSITORY / "build")
    arguments = parser.parse_args()

    clean = [run for run in load_study(STUDIES / "recipes.toml").runs if run.name == CLEAN]
    noisy = load_study(STUDIES / "noisy_training.toml").runs
    results = [carry_out(run, arguments.build, workers=2) for run in (*clean, *noisy)]
    # All have the same test wires; a run's dataset is beside its folder.
    wires = read_test_set(Run(CLEAN, clean[0].config, arguments.build / CLEAN))
    tables = [rows(run, arguments.build, wires, "clean") for run in clean]
    tables += [rows(run, arguments.build, wires, "noisy") for run in noisy]
    table = pd.concat(tables)
    with replacing(arguments.output) as temporary:
        table.to_csv(temporary, index=False)
    made = {
        **provenance("python results/noise.py"),
        "minutes": round(sum(result.minutes for result in results), 2),
        "sha256": hashlib.sha256(arguments.output.read_bytes()).hexdigest(),
    }
    write_json(arguments.output.with_suffix(".json"), {"provenance": made})
    print(table.to_string(index=False))


if __name__ == "__main__":
    main()
