"""Every command with options and files of every kind: what it promises, or one message.

Never a traceback, a warning or a file left behind by what is refused, nor a wait of more than 20 s.
What would take long is left out once all has been checked (`cheap`).
"""

import io
import json
import re
import subprocess
import sys
import tempfile
import tomllib
from contextlib import suppress
from dataclasses import dataclass, fields
from pathlib import Path

import h5py
import numpy as np
import pytest
import typer
import xarray as xr
from hypothesis import strategies as st

import disorder_landscape.bench.report
import disorder_landscape.executors.dask_cluster
import disorder_landscape.inference.infer
import disorder_landscape.learning.model
import disorder_landscape.learning.training
import disorder_landscape.studies.runner
from command_line import landscape
from disorder_landscape import Prior
from disorder_landscape.cli import app
from disorder_landscape.files import write_json
from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.runs import REPOSITORY
from disorder_landscape.studies.study import Derived
from odd_arguments import argument_sets, datasets, in_time, tried
from test_fuzz_functions import (
    FURTHER,
    INVERSION,
    LABELS,
    LARGER,
    MEASURED,
    MODEL,
    PREDICTION,
    FirstNumbers,
    one_optimum,
)

TEXTS = ["", " ", "x", "nan", "inf", "-inf", "1e400", "-1", "0", "1", "2", "3.5", "1e-320"]
TEXTS += ["0x10", "1_0", "１", "½", "1,2", "1:2", "0:1:3:4", ":", ",", "::", "0:1:x", "0:1:-1"]
TEXTS += ["0:1:0", "0:1:1e3", "inf:0:3", "nan:1:2", "-1.7e308:1.7e308:3", "True", "None", "1j"]
TEXTS += ["9" * 30, "1" * 5000, "0:1:1000000000000000", "é", "--", "\t", "'", "%s", "{}", "{x}"]
TEXTS += ["0,0.1,", "1e-300", "1e300", "-1e300", "0.1,0.1", "0.2,0.1", "*", "~", "$HOME", "\\"]
"""What may stand where a number, a grid or a word is expected."""

NEW_FILES = ["new.nc", "new.png", "new.NC", "new", ".nc", "", ".", "..", "/", "a b.nc", "Äθ.nc"]
NEW_FILES += ["folder.nc", "folder", "words.csv/new.nc", "deep/er/new.nc", "/dev/null/new.nc"]
NEW_FILES += ["/proc/new.nc", "/proc/new/new.nc", "a" * 240 + ".nc", "a" * 300 + ".nc", "x.nc/"]
NEW_FILES += ["a/" * 2100 + "new.nc", "~/../new.nc", "%s.nc", "{}.nc", "wire.nc", "link.nc"]
"""What may stand where the name of a new file or folder is expected."""


BAR = re.compile(r"\r?[a-z]+: +\d+%\|[^\r\n]*\]")
"""A progress bar."""


def texts(*usual):
    """Draw one of the usual texts of an option, or something else."""
    return st.one_of(*[st.sampled_from(usual)] * 3, st.sampled_from(TEXTS), st.text(max_size=4))


def safe(text):
    """Return whether a shell could hand over such a word, to one line of a message."""
    return all(char.isprintable() or char == "\t" for char in text)


@dataclass(frozen=True)
class Command:
    """A command: words, and files by their names, as text, bytes or a Dataset."""

    words: tuple
    files: dict


def commands(name, arguments, options, files=None, usual=None):
    """Draw a command: arguments, up to three options other than usual, and its files.

    All options that it has must be among those that are drawn.
    """
    parameters = typer.main.get_command(app).commands[name].params
    names = {one.opts[0] for one in parameters if one.param_type_name == "option"}
    assert set(options) == names, set(options) ^ names

    @st.composite
    def one(draw):
        chosen = {**(usual or {})}
        for option in draw(st.lists(st.sampled_from(sorted(options)), max_size=3, unique=True)):
            chosen[option] = draw(options[option])
        words = [word for word in draw(arguments) if safe(word)]
        for option, value in chosen.items():
            if value is True:
                words.append(option)
            elif value is not None and safe(value):
                words.append(f"{option}={value}")
        words += draw(st.sampled_from([[]] * 20 + [["--unknown"], ["further"], words[-1:]]))
        return Command((name, *words), {} if files is None else draw(files))

    return one()


def written_by(command):
    """Return the netCDF files that a command has written where it said it would, at least one.

    None where it only prints what jobs would do, or does a share of few tasks.
    """
    output = Path([word for word in command.words if word.startswith("--output=")][-1][9:])
    there = sorted(output.glob("*.nc")) if output.is_dir() else [output]
    does_less = "--dry-run" in command.words or any(
        word.startswith("--share=") and word != "--share=1/1" for word in command.words
    )
    assert there or does_less
    return there


def snapshot(folder):
    """Return all files and folders with their content."""
    return {
        path: path.read_bytes() if path.is_file() else None for path in sorted(folder.rglob("*"))
    }


@pytest.fixture
def cheap(monkeypatch, trained_folder):
    """Leave out what takes long, which comes after all checks."""

    def end(*arguments, **options):
        raise typer.Exit(0)

    def network(path, compiled=False):
        return FirstNumbers()

    monkeypatch.setattr(disorder_landscape.inference.infer, "invert", one_optimum)
    monkeypatch.setattr(disorder_landscape.learning.model, "load_network", network)
    monkeypatch.setattr(disorder_landscape.learning.training, "_train_one", end)
    monkeypatch.setattr(disorder_landscape.bench.report, "measure", end)
    monkeypatch.setattr(disorder_landscape.executors.dask_cluster, "ANSWERS_WITHIN", 1)
    monkeypatch.setattr(
        disorder_landscape.studies.runner, "carry_out", lambda study, place, limit: Derived()
    )
    monkeypatch.setenv("PATH", "")  # no job is handed to a Slurm that may be there


@pytest.fixture
def refused_or_done(monkeypatch, capsys, cheap, trained_folder):
    """Return a function that carries a command out and requires what is promised."""

    def check(command, wanted=lambda command: None):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            monkeypatch.chdir(folder)
            lay_out(folder, command.files, trained_folder)
            before = snapshot(folder)
            with in_time():
                code, out, err = landscape(monkeypatch, capsys, *command.words)
            assert code in (0, 1, 2, None), code
            assert "Traceback" not in err
            assert "Warning" not in err
            if code in (0, None):
                wanted(command)
                return "done", out
            err = BAR.sub("", err).lstrip()
            is_usage = err.startswith("Usage: ") and err.count("Error: ") == 1
            if code == 1:
                assert "without a result: " in err
            elif not is_usage:
                assert err.startswith("landscape: "), err
                assert err.count("\n") == 1, err
            if code == 2:
                assert snapshot(folder) == before, set(snapshot(folder)) ^ set(before)
            return "refused", err

    yield check
    monkeypatch.chdir(REPOSITORY)


def lay_out(folder, files, model):
    """Write the files of a command, and those that every command finds."""
    (folder / "folder.nc").mkdir()
    (folder / "folder").mkdir()
    (folder / "words.csv").write_text("V\nfirst\nsecond\n")
    (folder / "empty").write_bytes(b"")
    (folder / "link.nc").symlink_to("nowhere.nc")
    (folder / "model").symlink_to(model)
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if isinstance(content, xr.Dataset):
            content.to_netcdf(path, engine="h5netcdf")
        elif isinstance(content, str):
            path.write_text(content, "utf-8")
        else:
            path.write_bytes(content)


@pytest.fixture(scope="module")
def trained_folder(tmp_path_factory):
    """Return the folder of a model whose network is not there, but replaced (`cheap`)."""
    folder = tmp_path_factory.mktemp("model")
    (folder / "network.keras").write_bytes(b"")
    write_json(folder / "config.json", {"config": MODEL.config.model_dump(mode="json")})
    write_json(folder / "scaler.json", {"labels": LABELS.to_dict(), "inputs": None})
    write_json(folder / "metrics.json", {"r2_by_label": {"c_1": 0.9, "c_2": 0.9, "alpha": 0.5}})
    return folder


# Files of a wrong kind


def _hdf5(fill):
    content = io.BytesIO()
    with h5py.File(content, "w") as file:
        fill(file)
    return content.getvalue()


def _npy(header, data=b"", version=(1, 0)):
    text = header.encode("latin1") + b"\n"
    return b"\x93NUMPY" + bytes(version) + len(text).to_bytes(2, "little") + text + data


def _saved(values, **options):
    content = io.BytesIO()
    np.save(content, values, **options)
    return content.getvalue()


def _attributes(file, **attributes):
    file["potential"] = np.zeros(6)
    for name, value in attributes.items():
        file["potential"].attrs[name] = value


PNG = bytes.fromhex("89504e470d0a1a0a0000000d49484452") + bytes(60)
ODD_BYTES = {
    "empty": b"",
    "png": PNG,
    "text": b"no\nfile\nof\nnumbers\n",
    "latin": "µ,é\n1,2\n".encode("latin1"),
    "nul": b"0.1\n\x00\n0.2\n",
    "huge number": b"1e400\n" * 6,
    "six": b"0.1\n" * 6,
    "six, big": b"1e300\n" * 6,
    "one line": b"V",
    "hdf5 begins": b"\x89HDF\r\n\x1a\n" + bytes(100),
    "netcdf 3": b"CDF\x01" + bytes(100),
    "zip": b"PK\x03\x04" + bytes(60),
    "hdf5, nothing": _hdf5(lambda file: None),
    "hdf5, no dims": _hdf5(_attributes),
    "hdf5, complex": _hdf5(lambda file: file.update(potential=np.zeros(6) + 1j)),
    "hdf5, texts": _hdf5(lambda file: file.update(potential=np.array([b"a"] * 6))),
    "hdf5, compound": _hdf5(lambda file: file.update(potential=np.zeros(6, "f8,f8"))),
    "hdf5, bool": _hdf5(lambda file: file.update(potential=np.zeros(6, "?"))),
    "hdf5, group": _hdf5(lambda file: file.create_group("potential")),
    "hdf5, scalar": _hdf5(lambda file: file.update(potential=0.1)),
    "hdf5, null": _hdf5(lambda file: file.update(potential=h5py.Empty("f8"))),
    "hdf5, soft link": _hdf5(lambda file: file.update(potential=h5py.SoftLink("/nowhere"))),
    "hdf5, cycle": _hdf5(lambda file: file.update(potential=h5py.SoftLink("/potential"))),
    "hdf5, external": _hdf5(lambda file: file.update(potential=h5py.ExternalLink("no.h5", "/V"))),
    "hdf5, opaque": _hdf5(lambda file: file.update(potential=np.zeros(6, "V4"))),
    "hdf5, references": _hdf5(
        lambda file: file.create_dataset("potential", data=[file.ref] * 6, dtype=h5py.ref_dtype)
    ),
    "hdf5, days": _hdf5(lambda file: _attributes(file, units="days")),
    "hdf5, days since": _hdf5(lambda file: _attributes(file, units="days since 2000-01-01")),
    "hdf5, days since when": _hdf5(lambda file: _attributes(file, units="days since when")),
    "hdf5, scale": _hdf5(lambda file: _attributes(file, scale_factor="large")),
    "hdf5, scales": _hdf5(lambda file: _attributes(file, scale_factor=[1.0, 2.0])),
    "hdf5, fill": _hdf5(lambda file: _attributes(file, _FillValue=0.0, missing_value=1.0)),
    "hdf5, fill text": _hdf5(lambda file: _attributes(file, _FillValue="x")),
    "hdf5, coordinates": _hdf5(lambda file: _attributes(file, coordinates="a b c")),
    "hdf5, coordinates 3": _hdf5(lambda file: _attributes(file, coordinates=3)),
    "hdf5, unsigned": _hdf5(lambda file: _attributes(file, _Unsigned="true")),
    "hdf5, dtype": _hdf5(lambda file: _attributes(file, dtype="bool")),
    "hdf5, calendar": _hdf5(lambda file: _attributes(file, units="days since 1-1-1", calendar="x")),
    "npy, six": _saved(np.zeros(6)),
    "npy, objects": _saved(np.array([None] * 6), allow_pickle=True),
    "npy, complex": _saved(np.zeros(6) + 1j),
    "npy, texts": _saved(np.array(["0.1"] * 6)),
    "npy, dates": _saved(np.zeros(6, "M8[s]")),
    "npy, fields": _saved(np.zeros(6, "f8,f8")),
    "npy, 2-d": _saved(np.zeros((6, 1))),
    "npy, scalar": _saved(np.array(0.1)),
    "npy, long": _saved(np.zeros(6, np.longdouble) + np.longdouble("1e4000")),
    "npy, not closed": _npy("{'descr': '<f8', 'fortran_order': False, 'shape': (6,"),
    "npy, not indented": _npy("  {\n 'descr'\n   : 1L\n"),
    "npy, nested": _npy("(" * 3000),
    "npy, kind": _npy("{'descr': 'what', 'fortran_order': False, 'shape': (6,)}"),
    "npy, keys": _npy("{1: 2, 'a': 3}"),
    "npy, negative": _npy("{'descr': '<f8', 'fortran_order': False, 'shape': (-6,)}"),
    "npy, huge": _npy("{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000000,)}"),
    "npy, huger": _npy("{'descr': '<f8', 'fortran_order': False, 'shape': (10**30,)}"),
    "npy, hugest": _npy("{'descr': '<f8', 'fortran_order': False, 'shape': (%s,)}" % ("9" * 30)),
    "npy, version": _npy("{}", version=(9, 9)),
    "npy, cut off": _saved(np.zeros(6))[:-8],
    "npz": (lambda file: (np.savez(file, V=np.zeros(6)), file.getvalue())[1])(io.BytesIO()),
}
"""Files that are something else, some of them a potential of six sites."""
odd_bytes = st.one_of(st.sampled_from(sorted(ODD_BYTES)).map(ODD_BYTES.get), st.binary(max_size=99))


# simulate

SMALL = {"--sites": "6", "--B": "0:0.8:2", "--bias": "-0.02,0.02", "--output": "new.nc"}


def _simulated(command):
    for path in written_by(command):
        with xr.open_dataset(path, engine="h5netcdf") as written:
            for name in (*CONDUCTANCES, "T_IV", "potential"):
                assert np.isfinite(written[name]).all()


WIRE_OPTIONS = {
    "--potential": st.sampled_from(["V.csv", "V.npy", "V.nc", *NEW_FILES]),
    "--seed": texts("0", "3", "-3", "99999999999999999999"),
    "--components": texts("0", "2", "5", "6"),
    "--sites": texts("6", "2", "1", "0", "9", "-6", "1000000000000000"),
    "--alpha": texts("0", "8", "100", "101"),
    "--g": texts("0", "25", "100"),
    "--gamma": texts("0", "0.15", "10"),
    "--delta0": texts("0.12", "0.001", "10", "0"),
    "--critical-field": texts("1", "0.5", "inf", "0"),
    "--barrier": texts("15", "0,30", "-5,5", "1,2,3", "15,", "1e3,-1e3"),
    "--mass": texts("0.03", "0.01", "10", "0"),
    "--lattice": texts("10", "1", "100", "0"),
    "--lead-mu": texts("25", "0", "1000", "-5"),
    "--theta": texts("0", "30", "90", "360", "361"),
    "--temperature": texts("0", "0.05", "0.2", "10", "11"),
    "--output": st.sampled_from(NEW_FILES),
    "--plot": st.sampled_from(["new.png", "new.pdf", "new.svg", "new.jpg", *NEW_FILES]),
}
POTENTIALS = st.fixed_dictionaries(dict.fromkeys(("V.csv", "V.npy", "V.nc"), odd_bytes))


@argument_sets(20)
def test_simulate_writes_or_refuses(count, refused_or_done):
    options = {
        **WIRE_OPTIONS,
        "--mu": texts("0", "0,0.1", "0:0.6:2", "-5:30:3"),
        "--B": texts("0", "0.1,0.5", "0:0.8:2", "-1:5:3"),
        "--bias": texts("0", "-0.04:0.04:3", "0.11", "0.12"),
        "--solver": texts("fast", "Fast"),
        "--dissipation": texts("0", "0.01", "1", "-1"),
        "--parent-dissipation": texts("0", "0.01", "1", "-1"),
    }
    one = commands("simulate", st.just([]), options, POTENTIALS, SMALL)
    tried(count, one, lambda command: refused_or_done(command, _simulated))


@argument_sets(15)
def test_modes_writes_or_refuses(count, refused_or_done):
    options = {
        **WIRE_OPTIONS,
        "--mu": texts("0", "0.1", "-5", "30"),
        "--B": texts("0", "0.5", "-1", "5"),
        "--count": texts("1", "4", "12", "13", "0"),
        "--energy": texts("0", "-0.1:0.1:3", "0.12", "-100,100", "200"),
    }
    usual = {"--sites": "6", "--count": "1", "--energy": "-0.1:0.1:3", "--output": "new.nc"}

    def wanted(command):
        for path in written_by(command):
            with xr.open_dataset(path, engine="h5netcdf") as written:
                for name in ("level", "wave_function", "LDOS_electron", "overlap"):
                    assert np.isfinite(written[name]).all()

    one = commands("modes", st.just([]), options, POTENTIALS, usual)
    tried(count, one, lambda command: refused_or_done(command, wanted))


# TOML files


class Raw(str):
    """A value as it stands in a TOML file."""

    __slots__ = ()


VALUES = ["nan", "inf", "-inf", "-1", "0", "1", "2", "1.5", "0.5", "1e300", "1e-300", "1e-5"]
VALUES += ['"x"', '""', "[]", "{}", "[1, 2]", "[2, 1]", "true", "false", "1979-05-27", "07:32:00"]
VALUES += ["[nan]", "[inf]", "[0.0, 0.0]", "[0.5]", "[nan, nan]", "[0.0, inf]", "[50.0, 150.0]"]
VALUES += ["[1e300, 1.7e308]", "0x2", "1e400", '"a\\nb"', '"\\u0000"', "[[1]]", "[{}]", "{a = 1}"]
VALUES += ["[8.0, 8.0]", "[0, 1e-300]", '"double"', '"residual"', '"cosine"', "[1, 1]", '["a"]']
LARGE = ["99999999999999999999", "9" * 30, "1" * 5000, "4294967296"]
"""Also where nothing has that size."""


def toml(content):
    """Return a TOML file of nested dicts."""
    return "".join(
        f"[{key}]\n{_lines(value)}" if isinstance(value, dict) else f"{key} = {_value(value)}\n"
        for key, value in sorted(content.items(), key=lambda item: isinstance(item[1], dict))
    )


def _lines(table):
    return "".join(f"{key} = {_value(value)}\n" for key, value in table.items())


def _value(value):
    if isinstance(value, Raw):
        return value
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {_value(one)}" for key, one in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_value, value)) + "]"
    return json.dumps(value)


BROKEN = {
    "empty": b"",
    "png": PNG,
    "not closed": b"[dataset",
    "latin": "[dataset]\n# µ\n".encode("latin1"),
    "mark": b"\xef\xbb\xbf[dataset]\nrealizations = 2\n",
    "twice": b"[dataset]\nrealizations = 2\nrealizations = 2\n",
    "deep list": b"a = " + b"[" * 9000,
    "deep table": b"a = " + b"{b=" * 9000,
    "deep key": b"[" + b"a." * 9000 + b"a]",
    "long number": b"a = " + b"1" * 5000,
    "nul": b"a = 1\x00",
    "date": b"a = 2020-13-45",
    "carriage": b"[dataset]\rrealizations = 2\r",
}
broken = st.sampled_from(sorted(BROKEN)).map(BROKEN.get)


def tomls(usual, others, large=(), sections=True):
    """Draw a TOML file with up to three values, or keys, that are others."""
    keys = [(section, key) for section, table in others.items() for key in table]

    @st.composite
    def one(draw):
        content = {name: dict(table) for name, table in usual.items()}
        for section, key in draw(st.lists(st.sampled_from(keys), max_size=3, unique=True)):
            values = VALUES + LARGE if (section, key) in large else VALUES
            content.setdefault(section, {})[key] = Raw(draw(st.sampled_from(values)))
        change = draw(st.sampled_from(["none"] * 9 + ["key", "section", "drop", "value"]))
        if change == "key":
            content[draw(st.sampled_from(sorted(content)))]["unknown"] = 1
        elif change == "section":
            content["unknown"] = {}
        elif change == "drop":
            content.pop(draw(st.sampled_from(sorted(content))))
        elif change == "value" and sections:
            section = draw(st.sampled_from(sorted(content)))
            content[section] = Raw(draw(st.sampled_from(VALUES)))
        return toml(content if sections else content.get("", {}))

    return st.one_of(*[one()] * 9, broken)


TINY = {
    "dataset": {
        "realizations": 4,
        "components": 2,
        "sites": 10,
        "mu_points": 2,
        "B_points": 2,
        "bias": [0.0],
        "shard_size": 2,
    },
    "training": {"epochs": [1], "test_fraction": 0.5, "batch_size": 2},
    "network": {"width_fraction": 0.03},
}
DATASET_KEYS = [*TINY["dataset"], "alpha_range", "correlation_length", "amplitude", "mu_max"]
DATASET_KEYS += ["B_max", "temperature", "energy_spacing", "wire", "seed"]
TRAINING_KEYS = ["realizations", "epochs", "passes", "schedule", "learning_rate", "weight_decay"]
TRAINING_KEYS += ["batch_size", "test_fraction", "precision", "compress_inputs", "mirror"]
TRAINING_KEYS += ["predict_mean", "noise", "noise_up_to", "networks", "seed"]
RUN_KEYS = {
    "dataset": DATASET_KEYS,
    "training": TRAINING_KEYS,
    "network": ["architecture", "width_fraction"],
    "figures": ["realizations", "alpha_samples", "bias_max"],
}
HAS_NO_SIZE = [("dataset", "seed"), ("dataset", "shard_size"), ("training", "seed")]
HAS_NO_SIZE += [("training", "realizations"), ("training", "batch_size")]
SITE = {"": {"partition": "main", "jobs": 3, "minutes": 5}}
SITE_KEYS = {"": ["partition", "jobs", "minutes", "memory_gb", "cores", "at_a_time", "options"]}
SITE_KEYS[""] += ["setup", "unknown"]


def starts_processes(workers):
    """Return whether so many workers are processes of their own, which take seconds to start."""
    with suppress(ValueError):
        return 1 < int(workers) <= 1024
    return False


SHARES = texts("1/1", "1/2", "2/2", "0/1", "3/2", "1/0", "1", "a/b", "1/1/1", "-1/2", "²/2")
ELSEWHERE = {
    "--share": SHARES,
    "--executor": texts("local", "slurm", "slurm", "Local"),
    "--site": st.sampled_from(["site.toml", "site.toml", "nowhere.toml", "folder", "", "empty"]),
    "--dry-run": st.just(True),
    "--workers": texts("1", "0", "-1", "1025").filter(lambda text: not starts_processes(text)),
    "--scheduler": st.sampled_from(["tcp://localhost:1", "x", ""]),
}
CONFIGS = st.sampled_from(["run.toml"] * 12 + ["nowhere.toml", "folder", "", "empty", *NEW_FILES])
BUILDS = st.sampled_from(["build", "build", "folder", "empty", "new/build", *NEW_FILES])
SITES = tomls(SITE, SITE_KEYS, sections=False)


def run_files(others=RUN_KEYS):
    """Draw the files of a run: its configuration, and a site's."""
    run = tomls(TINY, others, HAS_NO_SIZE)
    return st.fixed_dictionaries({"run.toml": run, "site.toml": SITES})


def _generated(command):
    for path in Path().rglob("shard-*.nc"):
        with xr.open_dataset(path, engine="h5netcdf") as written:
            for name in (*CONDUCTANCES, "potential", "components", "alpha"):
                assert np.isfinite(written[name]).all()


@argument_sets(12)
def test_generate_makes_a_dataset_or_refuses(count, refused_or_done):
    options = {"--config": CONFIGS, "--build": BUILDS, **ELSEWHERE}
    usual = {"--config": "run.toml", "--workers": "1", "--build": "build"}
    files = run_files({"dataset": DATASET_KEYS, "figures": ["bias_max"]})
    one = commands("generate", st.just([]), options, files, usual)
    tried(count, one, lambda command: refused_or_done(command, _generated))


def built(folder=None):
    """Return the files of a dataset that TINY describes."""
    from disorder_landscape import chain, runs
    from disorder_landscape.executors.local import IN_THIS_PROCESS

    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "run.toml").write_text(toml(TINY))
        run = runs.open_run(Path(name) / "run.toml", Path(name) / "build")
        chain.generate(run, IN_THIS_PROCESS)
        paths = list(Path(name).rglob("shard-*.nc"))
        return {str(path.relative_to(name)): path.read_bytes() for path in paths}


@pytest.fixture(scope="module")
def dataset_files():
    return built()


def with_odd(files):
    """Draw these files, one of them now and then another."""

    @st.composite
    def one(draw):
        content = dict(files)
        if draw(st.integers(0, 3)) == 0:
            content[draw(st.sampled_from(sorted(content)))] = draw(odd_bytes)
        return content

    return one()


@argument_sets(20)
def test_status_says_how_much_is_there_or_refuses(count, refused_or_done, dataset_files):
    jobs = st.sampled_from(["{}", "[]", '{"jobs": [1]}', '{"jobs": 3}', "x", '{"jobs": [null]}'])
    files = st.builds(
        lambda run, there, jobs: run | there | {"build/jobs/generate-run/jobs.json": jobs},
        run_files(),
        with_odd(dataset_files),
        jobs,
    )
    options = {"--config": CONFIGS, "--build": BUILDS}
    usual = {"--config": "run.toml", "--build": "build"}
    one = commands("status", st.just([]), options, files, usual)
    tried(count, one, refused_or_done)


@argument_sets(10)
def test_train_begins_or_refuses(count, refused_or_done, dataset_files):
    others = {name: keys for name, keys in RUN_KEYS.items() if name != "dataset"}
    others["dataset"] = ["realizations"]
    files = st.builds(lambda run, there: run | there, run_files(others), with_odd(dataset_files))
    options = {"--config": CONFIGS, "--build": BUILDS}
    usual = {"--config": "run.toml", "--build": "build"}
    one = commands("train", st.just([]), options, files, usual)
    tried(count, one, refused_or_done)


JSON_VALUES = [None, True, -1, 0, 3, 0.5, "x", "", [], {}, [1], ["a"], {"a": 1}, 1e308, "nan"]


@st.composite
def odd_model(draw):
    """Draw the files of a model, in which some value is another."""
    content = {
        "config.json": {"config": MODEL.config.model_dump(mode="json")},
        "scaler.json": {"labels": LABELS.to_dict(), "inputs": None},
        "metrics.json": {"r2_by_label": {"c_1": 0.9, "c_2": 0.9, "alpha": 0.5}},
        "network.keras": "",
    }
    for _ in range(draw(st.integers(0, 2))):
        place = content
        name = draw(st.sampled_from(sorted(place)))
        while isinstance(place[name], dict) and place[name] and draw(st.integers(0, 3)):
            place = place[name]
            name = draw(st.sampled_from(sorted(place)))
        if draw(st.booleans()):
            place[name] = draw(st.sampled_from(JSON_VALUES))
        else:
            del place[name]
        if not content:
            break
    return {
        f"odd/{name}": one if isinstance(one, str) else json.dumps(one)
        for name, one in content.items()
    }


@argument_sets(12)
def test_evaluate_scores_or_refuses(count, refused_or_done, dataset_files):
    model = odd_model().map(
        lambda files: {name.replace("odd", "build/run/model"): one for name, one in files.items()}
    )
    files = st.builds(
        lambda *parts: {k: v for part in parts for k, v in part.items()},
        run_files(),
        with_odd(dataset_files),
        st.one_of(st.just({}), model),
    )
    options = {"--config": CONFIGS, "--build": BUILDS}
    usual = {"--config": "run.toml", "--build": "build"}
    one = commands("evaluate", st.just([]), options, files, usual)
    tried(count, one, refused_or_done)


# Measurements and models


def _storable(G):
    """Return a dataset if netCDF can hold it, and a usual one otherwise."""
    if not isinstance(G, xr.Dataset):
        return MEASURED
    try:  # a warning is an error, too
        G = G.compute()
        G.to_netcdf(io.BytesIO(), engine="h5netcdf")
    except Exception:  # it is no file, whatever is wrong with it
        return MEASURED
    return G


def stored(usual, odds=12):
    """Draw what a file may hold that should hold a dataset like the usual ones."""
    made = datasets(usual, odds=odds).map(_storable)
    return st.one_of(*[made] * 5, odd_bytes)


MODELS = st.sampled_from(
    ["model"] * 6 + ["odd", "odd", "nowhere", "", "folder", "empty", "a" * 300]
)


@argument_sets(12)
def test_predict_writes_or_refuses(count, refused_or_done):
    files = st.builds(
        lambda G, model: {"wire.nc": G} | model, stored([MEASURED, MEASURED, LARGER]), odd_model()
    )
    which = st.sampled_from([["wire.nc"]] * 9 + [[], [""], ["folder"], ["nowhere.nc"], ["a" * 300]])
    options = {"--model": MODELS, "--output": st.sampled_from(NEW_FILES)}
    usual = {"--model": "model", "--output": "new.nc"}
    one = commands("predict", which, options, files, usual)

    def wanted(command):
        for path in written_by(command):
            with xr.open_dataset(path, engine="h5netcdf") as written:
                assert np.isfinite(written["potential"]).all()

    tried(count, one, lambda command: refused_or_done(command, wanted))


PRIOR = {"": {"components": 2, "sites": 10}}
PRIOR_KEYS = [field.name for field in fields(Prior)]


@argument_sets(8)
def test_infer_writes_or_refuses(count, refused_or_done):
    files = st.builds(
        lambda G, other, model: {"wire.nc": G, "other.nc": other} | model,
        stored([MEASURED, MEASURED, LARGER]),
        stored([FURTHER]),
        odd_model(),
    )
    lists = [["wire.nc"]] * 9 + [["wire.nc", "other.nc"]] * 2 + [["wire.nc", "wire.nc"]]
    lists += [[], [""], ["folder"], ["nowhere.nc"], ["a" * 300], ["wire.nc", "nowhere.nc"]]
    options = {
        "--model": MODELS,
        "--prior": st.sampled_from(["prior.toml"] * 3 + ["nowhere.toml", "folder", "", "empty"]),
        "--output": st.sampled_from(NEW_FILES),
        "--noise": texts("0", "0.01", "0.01,0.01,0.002,0.002", "1", "2", "0.1,0.1", "-0.1"),
        "--from-prior": st.just(True),
        "--discrepancy": st.just(True),
        "--samples": texts("2", "4", "3", "0", "-2"),
        "--seed": texts("0", "3", "-1", "2147483648", "4294967296"),
        "--plot": st.sampled_from(["new.png", "new.html", *NEW_FILES]),
        **ELSEWHERE,
    }
    usual = {"--model": "model", "--output": "new.nc", "--samples": "4"}
    files = st.builds(
        lambda files, site, prior: files | {"site.toml": site, "prior.toml": prior},
        files,
        SITES,
        tomls(PRIOR, {"": PRIOR_KEYS}, sections=False),
    )
    one = commands("infer", st.sampled_from(lists), options, files, usual)

    def wanted(command):
        for path in written_by(command):
            with xr.open_dataset(path, engine="h5netcdf") as written:
                assert np.isfinite(written["potential"]).all()
                assert written.attrs["verdict"]

    tried(count, one, lambda command: refused_or_done(command, wanted))


@argument_sets(8)
def test_verify_says_whether_or_refuses(count, refused_or_done):
    files = st.builds(
        lambda Y, G, model: {"Y.nc": Y, "wire.nc": G, "other.nc": FURTHER} | model,
        stored([PREDICTION, PREDICTION, INVERSION]),
        stored([FURTHER]),
        odd_model(),
    )
    lists = [["Y.nc", "wire.nc"]] * 9 + [
        ["Y.nc", "wire.nc", "other.nc"],
        ["Y.nc"],
        [],
        ["Y.nc", ""],
    ]
    lists += [["wire.nc", "Y.nc"], ["nowhere.nc", "wire.nc"], ["Y.nc", "a" * 300], ["folder"] * 2]
    options = {
        "--model": MODELS,
        "--noise": texts("0", "0.01", "0.01,0.01,0.002,0.002", "1", "2", "0.1,0.1", "-0.1"),
        "--controls": texts("19", "18", "0", "-19").filter(lambda text: len(text) < 9),
        "--seed": texts("0", "3", "-1", "99999999999999999999"),
        "--shifts": texts("0", "-0.01,0.01", "0:0.01:2", "0.01:0:2", "2"),
        "--output": st.sampled_from(NEW_FILES),
    }
    usual = {"--controls": "19", "--shifts": "0"}
    one = commands("verify", st.sampled_from(lists), options, files, usual)
    tried(count, one, refused_or_done)


PLANS = {
    path.stem: tomllib.loads(path.read_text("utf-8"))
    for path in sorted((REPOSITORY / "configs" / "studies").glob("*.toml"))
}


@st.composite
def plans(draw):
    """Draw the file of a study, in which some value is another."""
    content = json.loads(json.dumps(draw(st.sampled_from(list(PLANS.values())))))
    for _ in range(draw(st.integers(0, 2))):
        place, name = content, draw(st.sampled_from(sorted(content)))
        while isinstance(place[name], dict | list) and place[name] and draw(st.booleans()):
            place = place[name]
            names = sorted(place) if isinstance(place, dict) else range(len(place))
            name = draw(st.sampled_from(names))
        place[name] = Raw(draw(st.sampled_from(VALUES)))
    if draw(st.integers(0, 9)) == 0:
        content["unknown"] = 1
    return toml(content)


@argument_sets(20)
def test_study_begins_or_refuses(count, refused_or_done):
    files = st.fixed_dictionaries({"plan.toml": st.one_of(plans(), plans(), broken)})
    files = st.builds(lambda files, site: files | {"site.toml": site}, files, SITES)
    names = [["plan.toml"]] * 9 + [[name] for name in PLANS] + [[], [""], ["nowhere"], ["."]]
    names += [["nowhere.toml"], ["folder"], ["/"], ["../plan.toml"], ["a" * 300 + ".toml"]]
    options = {
        "--list": st.just(True),
        "--output": st.sampled_from(["results", *NEW_FILES]),
        "--build": BUILDS,
        "--limit": texts("0", "1", "-1"),
        **ELSEWHERE,
    }
    usual = {"--output": "results"}
    one = commands("study", st.sampled_from(names), options, files, usual)
    tried(count, one, refused_or_done)


@argument_sets(10)
def test_bench_begins_or_refuses(count, refused_or_done):
    options = {"--repeats": texts("1", "0", "5"), "--output": st.sampled_from(NEW_FILES)}
    one = commands("bench", st.just([]), options, usual={"--output": "bench"})
    tried(count, one, refused_or_done)


# What was found before


def run_of(**changes):
    """Return the files of a run with other values, one for each section."""
    content = {name: {**table, **changes.get(name, {})} for name, table in TINY.items()}
    return {"run.toml": toml(content)}


RUN = ("--config=run.toml", "--build=build", "--workers=1")
PREDICT = ("predict", "wire.nc", "--model=model", "--output=new.nc")
SIMULATE = ("simulate", "--sites=6", "--B=0:0.8:2", "--bias=-0.02,0.02", "--output=new.nc")
NPY, CSV = "--potential=V.npy", "--potential=V.csv"


def changed_measurement(**attributes):
    G = MEASURED.copy(deep=True)
    for name, units in attributes.items():
        G[name].attrs["units"] = units
    return G


FOUND = {
    "long name of an output": ((*SIMULATE, "--output=" + "a" * 300 + ".nc"), {}),
    "long path of an output": ((*SIMULATE, "--output=" + "a/" * 2100 + "new.nc"), {}),
    "an output that is the root": ((*SIMULATE, "--output=/"), {}),
    "long name of a plot": ((*SIMULATE, "--plot=" + "a" * 300 + ".png"), {}),
    "endless grid": ((*SIMULATE, "--mu=0:1:1000000000000000"), {}),
    "grid from infinity": ((*SIMULATE, "--mu=inf:0:3"), {}),
    "grid of the largest numbers": ((*SIMULATE, "--mu=-1.7e308:1.7e308:3"), {}),
    "endless wire": (("simulate", "--sites=1000000000000000", "-o", "new.nc"), {}),
    "wire of so many digits": (("simulate", "--sites=" + "9" * 30, "-o", "new.nc"), {}),
    "pgf needs LaTeX": ((*SIMULATE, "--plot=new.pgf"), {}),
    **{
        f"potential, {name}": (
            (*SIMULATE, f"--potential=V.{ending}"),
            {f"V.{ending}": content},
        )
        for name, content in ODD_BYTES.items()
        for ending in [{"n": "npy", "h": "nc"}.get(name[0], "csv")]
    },
    "npz for a potential": ((*SIMULATE, NPY), {"V.npy": ODD_BYTES["npz"]}),
    "hdf5 without dims": (PREDICT, {"wire.nc": ODD_BYTES["hdf5, no dims"]}),
    "times": (PREDICT, {"wire.nc": changed_measurement(G_LL="s")}),
    "dates": (PREDICT, {"wire.nc": changed_measurement(mu="days since 2000-01-01")}),
    "no dates": (PREDICT, {"wire.nc": changed_measurement(G_RL="days since when")}),
    "texts as conductances": (
        PREDICT,
        {"wire.nc": MEASURED.assign(G_LL=MEASURED.G_LL.astype("U9"))},
    ),
    "long name of a model": (("predict", "wire.nc", "--model=" + "a" * 300, "-o", "new.nc"), {}),
    "long name of a measurement": (("predict", "a" * 300, "--model=model", "-o", "new.nc"), {}),
    "long number in a file": (("status", *RUN[:2]), {"run.toml": BROKEN["long number"]}),
    "deep list in a file": (("status", *RUN[:2]), {"run.toml": BROKEN["deep list"]}),
    "deep table in a file": (("status", *RUN[:2]), {"run.toml": BROKEN["deep table"]}),
    "deep key in a file": (("status", *RUN[:2]), {"run.toml": BROKEN["deep key"]}),
    "long name of a build": (("status", RUN[0], "--build=" + "a" * 300), run_of()),
    "alpha up to infinity": (
        ("generate", *RUN),
        run_of(dataset={"alpha_range": Raw("[0.0, inf]")}),
    ),
    "alpha of the largest numbers": (
        ("generate", *RUN),
        run_of(dataset={"alpha_range": Raw("[1e300, 1.7e308]")}),
    ),
    "alpha beyond its range": (("generate", *RUN), run_of(dataset={"alpha_range": [200.0, 300.0]})),
    "bias beyond the gap": (("generate", *RUN), run_of(dataset={"bias": [0.5]})),
    "bias of no number": (("generate", *RUN), run_of(dataset={"bias": Raw("[nan]")})),
    "hardly any correlation": (
        ("generate", *RUN),
        run_of(dataset={"correlation_length": Raw("1e-300")}),
    ),
    "large seed": (("generate", *RUN), run_of(dataset={"seed": 10**20})),
    "larger seed": (("generate", *RUN), run_of(dataset={"seed": 10**30})),
    "large shards": (("generate", *RUN), run_of(dataset={"shard_size": 10**30})),
    "endless mu": (("generate", *RUN), run_of(dataset={"mu_points": 10**15})),
    "endless B": (("generate", *RUN), run_of(dataset={"B_points": 10**30})),
    "endless realizations": (("generate", *RUN), run_of(dataset={"realizations": 10**12})),
    "endless realizations, status": (
        ("status", *RUN[:2]),
        run_of(dataset={"realizations": 10**12}),
    ),
    "fine energies": (("generate", *RUN), run_of(dataset={"energy_spacing": Raw("1e-300")})),
    "hardly any temperature": (("generate", *RUN), run_of(dataset={"temperature": Raw("1e-300")})),
    "endless study": (
        ("study", "plan.toml", "--output=results"),
        {"plan.toml": toml({**PLANS["accuracy"], "wires": 10**12})},
    ),
    "a study for a Slurm that is not there": (
        ("study", "plan.toml", "--output=results", "--executor=slurm", "--site=site.toml"),
        {"plan.toml": toml(PLANS["accuracy"]), "site.toml": toml(SITE[""])},
    ),
    "a study's kind of two lines": (
        ("study", "plan.toml", "--output=results"),
        {"plan.toml": toml({**PLANS["accuracy"], "kind": "a\nb"})},
    ),
    "a key of two lines": (("status", *RUN[:2]), {"run.toml": '"a\\nb" = 1\n'}),
    "long name of a study": (("study", "a" * 300 + ".toml"), {}),
    "long name of tables": (("study", "accuracy", "--output=" + "a" * 300), {}),
    "long name of a benchmark": (("bench", "--output=" + "a" * 300), {}),
    "long name of a site": (
        ("generate", *RUN[:2], "--executor=slurm", "--dry-run", "--site=" + "a" * 300),
        run_of(),
    ),
    "no scheduler": (("generate", *RUN, "--executor=dask", "--scheduler="), run_of()),
    "unknown scheduler": (("generate", *RUN, "--executor=dask", "--scheduler=x://y:1"), run_of()),
    "port of no scheduler": (
        ("generate", *RUN, "--executor=dask", "--scheduler=tcp://localhost:99999999"),
        run_of(),
    ),
    "prediction of fewer sites than components": (
        ("verify", "Y.nc", "wire.nc", "--controls=19", "--shifts=0"),
        {"Y.nc": PREDICTION.isel(site=slice(2)), "wire.nc": FURTHER},
    ),
    "alpha is a text": (
        ("verify", "Y.nc", "wire.nc", "--controls=19", "--shifts=0"),
        {"Y.nc": PREDICTION.assign(alpha="x"), "wire.nc": FURTHER},
    ),
    "conductances of fewer dims": (
        ("infer", "wire.nc", "--model=model", "--output=new.nc", "--samples=4"),
        {"wire.nc": MEASURED.assign(G_LL=MEASURED["G_LL"].isel(mu=0, drop=True))},
    ),
    "an output whose name leaves no room": (
        ("infer", "wire.nc", "--model=model", "--output=" + "a" * 230 + ".nc", "--plot=new.png"),
        {"wire.nc": MEASURED},
    ),
    "a plot whose name leaves no room": ((*SIMULATE, "--plot=" + "a" * 240 + ".png"), {}),
    "advice on the network, and no mu": (
        ("infer", "wire.nc", "--model=model", "--output=new.nc", "--samples=4", "--noise=0.01"),
        {"wire.nc": MEASURED.drop_vars("mu")},
    ),
    "bias beyond the gap of a measurement": (
        ("infer", "wire.nc", "--model=model", "--from-prior", "--output=deep/new.nc"),
        {"wire.nc": LARGER.assign_coords(bias=[-0.5, 0.0, 0.5])},
    ),
}


@pytest.mark.parametrize("name", FOUND)
def test_what_was_found_is_answered_or_refused(name, refused_or_done):
    words, files = FOUND[name]
    refused_or_done(Command(words, files))


def test_a_name_that_is_no_text_is_refused_or_used(tmp_path):
    """Names of files are bytes; these are no UTF-8."""
    script = "from disorder_landscape.cli import main; main()"
    command = [sys.executable, "-c", script, "simulate", *SIMULATE[1:-1], "--output", b"\xff.nc"]
    done = subprocess.run(command, check=False, cwd=tmp_path, capture_output=True, timeout=60)
    assert b"Traceback" not in done.stderr
    assert done.returncode in (0, 2)
    assert done.returncode == 0 or not list(tmp_path.iterdir())
