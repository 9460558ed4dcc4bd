"""Inversions from file to file: one, many, and two processes that want the same."""

from functools import partial

import numpy as np
import pytest
import xarray as xr

from command_line import landscape
from disorder_landscape import ArgumentError
from disorder_landscape.executors.local import LocalProcesses
from disorder_landscape.inference import file
from disorder_landscape.inference.file import Task, infer_file
from disorder_landscape.inference.folder import infer_one_of_many, tasks_of_folder
from disorder_landscape.inference.settings import Settings
from measurements import CONFIG, write_measurements


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A disorder model without a network, three measurements, and a file that is none."""
    folder = tmp_path_factory.mktemp("many")
    write_measurements(folder)
    (folder / "thesis.nc").write_text("Chapter 1")
    return folder


def settings_of(folder, **changes):
    usual = {
        "prior": None,
        "model": folder / "model",
        "noise": None,
        "from_prior": True,
        "samples": 4,
        "seed": 0,
        "discrepancy": False,
        "made": {},
    }
    return Settings(**{**usual, **changes})


def tasks(folder, output, **changes):
    measurements = [folder / f"{i}.nc" for i in range(3)]
    return tasks_of_folder(measurements, output, None, settings_of(folder, **changes))


def content(path):
    return xr.load_dataset(path, engine="h5netcdf").drop_attrs(deep=False)


@pytest.fixture(scope="module")
def inferred(folder):
    for task in tasks(folder, folder / "results"):
        infer_file(settings_of(folder), task)
    return folder / "results"


def test_many_measurements_have_the_results_that_each_has_alone(
    monkeypatch, capsys, folder, inferred, tmp_path
):
    files = [folder / f"{i}.nc" for i in range(3)]
    command = ["infer", *files, folder / "thesis.nc", "--model", folder / "model", "--from-prior"]
    command += ["--samples", 4, "-o", tmp_path / "out", "--plot", tmp_path / "pictures"]
    code, out, said = landscape(monkeypatch, capsys, *command, "--share", "1/2")
    assert (code, "2 results are there; new: 2 converged" in out) == (0, True)
    made = (tmp_path / "out" / "0.nc").stat().st_mtime_ns
    code, out, said = landscape(monkeypatch, capsys, *command)
    assert (code, "3 results are there; new: 1 converged" in out) == (1, True)
    assert "thesis.nc: Argument file must be a netCDF file" in out + said
    assert "without a result: 1" in said
    assert (tmp_path / "out" / "0.nc").stat().st_mtime_ns == made
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["0.nc", "1.nc", "2.nc"]
    assert len(list((tmp_path / "pictures").glob("*.png"))) == 3
    for i in range(3):
        xr.testing.assert_identical(
            content(tmp_path / "out" / f"{i}.nc"), content(inferred / f"{i}.nc")
        )


def test_the_result_of_another_question_is_not_replaced(folder, inferred):
    assert all(task.is_done for task in tasks(folder, inferred))
    for change in ({"noise": 0.01}, {"seed": 1}, {"samples": 6}):
        with pytest.raises(ArgumentError, match="output must be a folder for results of these"):
            tasks(folder, inferred, **change)


@pytest.mark.parametrize("there", ["thesis", "measurement"])
def test_a_file_that_is_no_result_is_not_replaced(folder, tmp_path, there):
    source = folder / ("thesis.nc" if there == "thesis" else "1.nc")
    (tmp_path / "0.nc").write_bytes(source.read_bytes())
    with pytest.raises(ArgumentError, match="is another one's"):
        tasks(folder, tmp_path)
    assert (tmp_path / "0.nc").read_bytes() == source.read_bytes()


def test_measurements_of_one_name_are_refused(folder, tmp_path):
    settings = settings_of(folder)
    twice = [folder / "0.nc", folder / "other" / "0.nc"]
    with pytest.raises(ArgumentError, match="names of their own"):
        tasks_of_folder(twice, tmp_path, None, settings)
    with pytest.raises(ArgumentError, match="another folder than that of the measurements"):
        tasks_of_folder([folder / "0.nc"], folder, None, settings)
    with pytest.raises(ArgumentError, match="there is no"):
        tasks_of_folder([folder / "none.nc"], tmp_path, None, settings)


def test_pictures_are_drawn_of_results_that_are_there(
    monkeypatch, capsys, folder, inferred, tmp_path
):
    """… without another inversion."""
    monkeypatch.setattr(file, "infer", None)
    settings, one = settings_of(folder), [folder / "0.nc"]
    (task,) = tasks_of_folder(one, inferred, tmp_path / "pictures", settings)
    assert not task.is_done
    assert infer_one_of_many(settings, task).verdict
    assert task.is_done
    with pytest.raises(ArgumentError, match="plot must name a folder, as output does"):
        tasks_of_folder(one, inferred, tmp_path / "page.html", settings)
    command = ["infer", *one, "--model", folder / "model", "--from-prior", "--samples", 4]
    command += ["--workers", 1, "-o", inferred, "--plot", tmp_path / "others"]
    code, out, err = landscape(monkeypatch, capsys, *command)
    assert (code, "1 result is there; only drawn: 1" in out) == (0, True), out + err


def test_of_two_processes_with_one_output_one_waits(folder, inferred, tmp_path):
    """Both find the same, one after the other, and nothing else is left."""
    same = [Task(folder / "0.nc", tmp_path / "0.nc")] * 2
    infer_one = partial(infer_one_of_many, settings_of(folder))
    outcomes = list(LocalProcesses(2).each_result(infer_one, same))
    assert [outcome.verdict for outcome in outcomes] == ["converged"] * 2
    assert [path.name for path in tmp_path.iterdir()] == ["0.nc"]
    xr.testing.assert_identical(content(tmp_path / "0.nc"), content(inferred / "0.nc"))


def test_a_prior_serves_instead_of_a_model(monkeypatch, capsys, folder, inferred, tmp_path):
    """With the same in its file; another question if its file changes."""
    prior, (low, high) = tmp_path / "prior.toml", CONFIG.alpha_range
    said = f"components = {CONFIG.components}\nsites = {CONFIG.sites}\n"
    prior.write_text(f"{said}alpha = [{low}, {high}]\n" if low < high else said)
    command = ["infer", folder / "0.nc", "--prior", prior, "--samples", 4]
    code, out, err = landscape(monkeypatch, capsys, *command, "-o", tmp_path / "out.nc")
    assert (code, "verdict         converged" in out) == (0, True), err
    found, expected = content(tmp_path / "out.nc"), content(inferred / "0.nc")
    np.testing.assert_allclose(found["potential_mean"], expected["potential_mean"], atol=1e-4)
    assert set(found.variables) == set(expected.variables)
    several = ["infer", folder / "0.nc", folder / "1.nc", *command[2:], "-o", tmp_path / "all"]
    assert landscape(monkeypatch, capsys, *several)[0] == 0
    prior.write_text(f"{said}alpha = [6.0, 10.0]\n")
    code, _, err = landscape(monkeypatch, capsys, *several)
    assert code == 2
    assert "output must be a folder for results of these measurements" in err


def test_neither_prior_nor_model_is_refused(monkeypatch, capsys, folder, tmp_path):
    command = ["infer", folder / "0.nc", "-o", tmp_path / "out.nc"]
    code, _, err = landscape(monkeypatch, capsys, *command)
    assert code == 2
    assert "prior must be given, or a model whose dataset says what is known" in err
