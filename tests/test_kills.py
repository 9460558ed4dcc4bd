"""kill −9 at a hundred random moments: the same command ends with what an undisturbed one makes."""

import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from disorder_landscape.learning.curves import read_curves
from disorder_landscape.learning.model import load_model
from disorder_landscape.studies.rows import read_rows
from measurements import write_measurements

KILLS = 100
WIRE = "sites = 60\ncomponents = 2\nmu_points = 5\nB_points = 5\nbias = [-0.03, 0.0, 0.03]\n"
LEARNT = WIRE.replace("_points = 5", "_points = 8").replace("-0.03, 0.0", "-0.02, 0.0, 0.01")
TRAINING = f"""
[dataset]
realizations = 40
{LEARNT}
[network]
width_fraction = 0.01
[training]
epochs = [40]
"""
STUDY = f"""
kind = "trainings"
title = "three trainings"
[base.dataset]
realizations = 12
{LEARNT}
[base.network]
width_fraction = 0.01
[base.training]
epochs = [4]
test_fraction = 0.5
[[runs]]
name = "few"
[runs.grid]
"training.realizations" = [3, 4, 6]
"""


class Generate:
    def prepare(self, folder):
        text = f"[dataset]\nrealizations = 400\nshard_size = 10\n{WIRE}"
        (folder / "run.toml").write_text(text.replace("sites = 60", "sites = 300"))

    def command(self, folder, build):
        config = ("--config", folder / "run.toml", "--build", build)
        return "generate", *config, "--workers", 2

    def made(self, build):
        return {path.name: path.read_bytes() for path in build.rglob("*.nc")}


class Train:
    def prepare(self, folder):
        (folder / "run.toml").write_text(TRAINING)
        config = ("--config", folder / "run.toml", "--build", folder / "data")
        ends_well(begun(("generate", *config)))

    def command(self, folder, build):
        if not build.exists():
            shutil.copytree(folder / "data", build)
        return "train", "--config", folder / "run.toml", "--build", build

    def made(self, build):
        """Return the weights and the curves to seven digits: threads add up in any order."""
        [network] = build.rglob("network.keras")
        weights = load_model(network.parent).network.get_weights()
        losses = [epoch.loss for epoch in read_curves(network.parent / "curves.csv")]
        return np.round(np.concatenate([np.ravel(array) for array in (*weights, losses)]), 6)


class Infer:
    def prepare(self, folder):
        write_measurements(folder)

    def command(self, folder, build):
        measurements = [folder / f"{i}.nc" for i in range(3)]
        options = ("--model", folder / "model", "--from-prior", "--samples", 16, "-o", build)
        return "infer", *measurements, *options, "--workers", 2

    def made(self, build):
        found = {}
        for path in build.glob("*.nc"):
            dataset = xr.load_dataset(path, engine="h5netcdf")
            found |= {(path.name, name): dataset[name].values for name in dataset.variables}
        return found


class Study:
    def prepare(self, folder):
        (folder / "plan.toml").write_text(STUDY)

    def command(self, folder, build):
        return "study", folder / "plan.toml", "-o", build, "--build", build, "--workers", 2

    def made(self, build):
        rows = read_rows(build / "plan.csv")
        return {row["key"]: round(float(row["R2"]), 6) for row in rows}


def begun(arguments):
    landscape = Path(sys.executable).with_name("landscape")
    command = [str(landscape), *map(str, arguments)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def ends_well(process):
    said, _ = process.communicate(timeout=600)
    assert process.returncode == 0, said
    assert "Traceback" not in said


def left_behind(build):
    """What only work that goes on may have."""
    return [p for p in build.rglob("*") if "writing" in p.name or p.name.endswith(".lock")]


@pytest.mark.slow
@pytest.mark.parametrize("kind", [Generate, Train, Infer, Study])
def test_a_hundred_kills_change_nothing(kind, tmp_path):
    """A run is killed until it has come to its end; then the next one begins."""
    kind = kind()
    kind.prepare(tmp_path)
    started = time.monotonic()
    ends_well(begun(kind.command(tmp_path, tmp_path / "whole")))
    duration = time.monotonic() - started
    whole = kind.made(tmp_path / "whole")
    rng = np.random.default_rng(0)
    kills = runs = 0
    while kills < KILLS:
        build = tmp_path / f"killed-{runs}"
        runs += 1
        for moment in rng.uniform(0.1, 1.1, size=4) * duration:
            process = begun(kind.command(tmp_path, build))
            try:
                process.communicate(timeout=moment)
                break
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGKILL)
                process.communicate()
                kills += 1
        ends_well(begun(kind.command(tmp_path, build)))
        np.testing.assert_equal(kind.made(build), whole)
        assert left_behind(build) == []
    print(f"{kind.__class__.__name__}: {kills} kills of {runs} runs, each {duration:.1f} s")
