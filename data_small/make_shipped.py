"""Make the shipped model and test set from the small preset's run, and SHA256SUMS of all data.

Run from the repository's root, after `make evaluate`: python data_small/make_shipped.py
"""

import hashlib
import shutil
from pathlib import Path

from disorder_landscape.chain import SHIPPED_MODEL, SHIPPED_TEST_SET, preset_run, read_test_set
from disorder_landscape.dataset.store import provenance, write_dataset

TEST_REALIZATIONS = 200
MODEL_FILES = ("network.keras", "scaler.json", "config.json", "metrics.json", "curves.csv")
DATA = Path(__file__).parent


def main() -> None:
    """Copy, cut and sum."""
    run = preset_run("small")
    SHIPPED_MODEL.mkdir(parents=True, exist_ok=True)
    for name in MODEL_FILES:
        shutil.copyfile(run.model_folder / name, SHIPPED_MODEL / name)
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
    write_dataset(test, SHIPPED_TEST_SET, attrs)
    files = sorted(
        path
        for path in DATA.rglob("*")
        if path.suffix in {".nc", ".keras", ".json", ".csv", ".png"}
    )
    sums = [
        f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.relative_to(DATA)}\n"
        for path in files
    ]
    (DATA / "SHA256SUMS").write_text("".join(sums))


if __name__ == "__main__":
    main()
