"""Make the shipped models and test sets from their runs, and SHA256SUMS of all data.

Run from the repository's root, once the runs are evaluated (`make evaluate PRESET=full` and
`make evaluate PRESET=full_ten_components`): python data_small/make_shipped.py. Names of models in
data_small/models make these only.
"""

import hashlib
import shutil
import sys
from pathlib import Path

from disorder_landscape.chain import (
    MODELS,
    Run,
    preset_run,
    read_test_set,
    shipped_model,
    shipped_test_set,
)
from disorder_landscape.dataset.store import provenance, write_dataset

PRESET = "full"
"""Whose runs are shipped."""
TEST_REALIZATIONS = 200
MODEL_FILES = ("network.keras", "scaler.json", "config.json", "metrics.json", "curves.csv")
DATA = Path(__file__).parent


def ship(run: Run, model: str) -> None:
    """Copy a trained model and the first of its test realizations."""
    folder = shipped_model(model)
    folder.mkdir(parents=True, exist_ok=True)
    for name in MODEL_FILES:
        shutil.copyfile(run.model_folder / name, folder / name)
    test = read_test_set(run).isel(realization=slice(TEST_REALIZATIONS))
    indices = test.realization.to_numpy()
    attrs = {
        **provenance("python data_small/make_shipped.py"),
        "config_hash": run.config.dataset.hash,
        "config": run.config.dataset.model_dump_json(),
        "seed": run.config.dataset.seed,
        "first_index": indices[0],
        "last_index": indices[-1],
    }
    write_dataset(test, shipped_test_set(model), attrs)


def write_sums() -> None:
    """Write the checksums of everything that is shipped."""
    suffixes = {".nc", ".keras", ".json", ".csv", ".png"}
    files = sorted(path for path in DATA.rglob("*") if path.suffix in suffixes)
    sums = [
        f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.relative_to(DATA)}\n"
        for path in files
    ]
    (DATA / "SHA256SUMS").write_text("".join(sums))


if __name__ == "__main__":
    for model in sys.argv[1:] or MODELS:
        ship(preset_run(PRESET, model=model), model)
    write_sums()
