"""Make the shipped models and test sets from their runs, and SHA256SUMS of all data.

Run from the repository's root, once the runs are evaluated (`make evaluate PRESET=full`,
PRESET=full_ten_components, PRESET=noisy and PRESET=noisy_ten_components) or, for the network of
thirty components, trained: python data_small/make_shipped.py. Names of presets, full or noisy, or
thirty make theirs only.
"""

import hashlib
import shutil
import sys
from pathlib import Path

from disorder_landscape.chain import read_test_set
from disorder_landscape.dataset.store import provenance, write_dataset
from disorder_landscape.runs import (
    MODELS,
    NOISY,
    NOISY_FROM,
    THIRTY,
    Run,
    open_run,
    preset_run,
    shipped_model,
    shipped_test_set,
)

PRESETS = {"full": 0.0, NOISY: NOISY_FROM}
"""Whose runs are shipped, and for errors from how many e²/h on; the test sets are the first's."""
TEST_REALIZATIONS = 200
MODEL_FILES = ("network.keras", "scaler.json", "config.json", "metrics.json", "curves.csv")
DATA = Path(__file__).parent


def ship_model(run: Run, folder: Path) -> None:
    """Copy a trained model."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in MODEL_FILES:
        shutil.copyfile(run.model_folder / name, folder / name)


def ship_test_set(run: Run, model: str) -> None:
    """Copy the first of a run's test realizations."""
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
    made = sys.argv[1:] or [*PRESETS, "thirty"]
    if unknown := set(made) - {*PRESETS, "thirty"}:
        sys.exit(f"each must be one of {', '.join([*PRESETS, 'thirty'])}, not {unknown.pop()}")
    if "thirty" in made:
        ship_model(open_run(f"configs/{THIRTY}.toml"), shipped_model(THIRTY))
    for preset in (name for name in made if name in PRESETS):
        for model in MODELS:
            run = preset_run(preset, model=model)
            ship_model(run, shipped_model(model, PRESETS[preset]))
            if preset != NOISY:
                ship_test_set(run, model)
    write_sums()
