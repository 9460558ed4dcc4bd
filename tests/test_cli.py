"""The command line: what it writes, and one sentence for whatever it cannot use."""

import json
import subprocess
import sys

import numpy as np
import pytest
import typer
import xarray as xr

from command_line import landscape
from disorder_landscape import ArgumentError, Nanowire, Prior, conductance
from disorder_landscape.cli import app
from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.potential_file import read_potential
from disorder_landscape.runs import FIVE, shipped_model

SMALL = ["--sites", "30", "--B", "0:0.8:5", "--bias", "-0.02,0,0.02"]


@pytest.mark.parametrize("ending", ["csv", "npy", "nc"])
def test_simulate_reads_a_potential_and_writes_what_the_library_says(
    monkeypatch, capsys, tmp_path, ending
):
    V = np.random.default_rng(0).normal(0, 0.3, 30)
    potential, output = tmp_path / f"V.{ending}", tmp_path / "wire.nc"
    if ending == "csv":
        rows = [f"{10 * i},{value!r}" for i, value in enumerate(V.tolist())]
        potential.write_text("x (nm),V (meV)\n" + "\n".join(rows))
    elif ending == "npy":
        np.save(potential, V)
    else:
        xr.Dataset({"potential": ("site", V)}).to_netcdf(potential, engine="h5netcdf")
    arguments = ["--potential", potential, *SMALL, "--mu", "0:0.6:3", "--alpha", 7, "-o", output]
    plot = tmp_path / "wire.png"
    code, out, err = landscape(monkeypatch, capsys, "simulate", *arguments, "--plot", plot)
    assert code == 0, err
    assert str(output) in out
    assert plot.read_bytes().startswith(b"\x89PNG")
    expected = conductance(
        Nanowire(V, alpha=7), np.linspace(0, 0.6, 3), np.linspace(0, 0.8, 5), [-0.02, 0, 0.02]
    )
    with xr.open_dataset(output, engine="h5netcdf") as written:
        for name in expected.data_vars:
            np.testing.assert_array_equal(written[name], expected[name])
        assert written.T_IV.dims == ("lead", "mu", "B")
        assert written.attrs["alpha"] == 7
        assert written.attrs["command"].startswith("landscape simulate --potential")


def test_simulate_broadens_levels(monkeypatch, capsys, tmp_path):
    written = []
    for width in (0, 1e-3):
        path = tmp_path / f"{width}.nc"
        given = "--seed", 3, "--dissipation", width, *SMALL, "-o", path
        assert landscape(monkeypatch, capsys, "simulate", *given)[0] == 0
        with xr.open_dataset(path, engine="h5netcdf") as dataset:
            written.append(dataset.load())
    sharp, broad = written
    assert "T_IV" in sharp
    assert "T_IV" not in broad
    assert broad.attrs["dissipation"] == broad.attrs["parent_dissipation"] == 1e-3
    assert abs(sharp.G_LL - broad.G_LL).max() > 1e-3


def test_simulate_draws_the_same_potential_for_the_same_seed(monkeypatch, capsys, tmp_path):
    for name in ("a.nc", "b.nc"):
        landscape(monkeypatch, capsys, "simulate", "--seed", 3, *SMALL, "-o", tmp_path / name)
    a, b = (xr.load_dataset(tmp_path / n, engine="h5netcdf") for n in ("a.nc", "b.nc"))
    xr.testing.assert_equal(a, b)
    assert a.potential.std() > 0.05


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--alpha", "-1"], "Argument alpha must be a number from 0 to 100 meV nm, but it is -1."),
        (["--alpha", "nan"], "Argument alpha must"),
        (["--g", "1000"], "Argument g must be a number from 0 to 100, but it is 1000."),
        (["--temperature", "-0.1"], "Argument temperature must"),
        (["--theta", "400"], "Argument theta must be a number from -360 to 360 degrees"),
        (["--barrier", "high"], "Argument barrier must be a number in meV, or two like 15,12"),
        (["--barrier", "1,2,3"], "Argument barrier must be a number in meV, or two like 15,12"),
        (["--barrier", "1,2000"], "Argument barrier must be a number from -1000 to 1000 meV"),
        (["--temperature", "2", "--solver", "kwant"], "keep |bias| + 10 kT below the gap"),
        (["--bias", "0.13", "--temperature", "0"], "Argument bias must lie between"),
        (["--bias", "0.1,0.0"], "Argument bias must be a number or an increasing list"),
        (["--mu", ""], "Argument mu must be a number, a list"),
        (["--mu", "0:1:0"], "Argument mu must be a number or an increasing list"),
        (["--B", "x"], "Argument B must be a number, a list"),
        (["--solver", "magic"], "Argument solver must be 'fast' or 'kwant'"),
        (["--sites", "1"], "Argument sites must be a number from 2 to 100000, but it is 1."),
        (["--components", "400", "--seed", "1"], "components must be a number from 0 to 299"),
        (["--components", "3"], "components must come with --seed, which draws them"),
        (["--components", "3", "--potential", "short.csv"], "components must come with --seed"),
        (["--components", "0", "--potential", "short.csv"], "components must come with --seed"),
        (["--potential", "no.csv"], "there is no 'no.csv'"),
        (["--potential", "words.csv"], "line 2 ends with 'first', which is no number"),
        (["--potential", "short.csv", "--sites", "3"], "must have 3 sites, as --sites says, but"),
        (["--potential", "row.csv"], "fewer than two lines with a number, one for each site"),
        (["--potential", "nan.csv"], "Argument potential must be finite"),
        (["--potential", "broken.npy"], "Argument potential must be a .csv, .npy or .nc file"),
        (["--potential", "broken.nc"], "Argument file must be a netCDF file"),
        (["--potential", "foreign.nc"], "lacks potential"),
        (["--potential", "short.csv", "--seed", "1"], "both are given"),
        (["--plot", "picture.xyz"], "Argument plot must end in one of"),
        (["--output", "x.png"], "Argument output must be a netCDF file, named ….nc, but it is"),
        (["--output", "words.csv/x.nc"], "Argument output must be a file in a folder that can be"),
        (["--output", "."], "Argument output must be a file in a folder that can be written"),
    ],
)
def test_bad_input_is_one_sentence(monkeypatch, capsys, tmp_path, options, says):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "words.csv").write_text("V\nfirst\nsecond\n")
    (tmp_path / "short.csv").write_text("0.1\n0.2\n")
    (tmp_path / "row.csv").write_text("0.1,0.2,0.3\n")
    (tmp_path / "nan.csv").write_text("\n".join(["nan"] * 300))
    (tmp_path / "broken.npy").write_bytes(b"\x93NUMPY\x01")
    (tmp_path / "broken.nc").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(100))
    xr.Dataset({"x": 1.0}).to_netcdf(tmp_path / "foreign.nc", engine="h5netcdf")
    before = sorted(tmp_path.iterdir())
    code, out, err = landscape(monkeypatch, capsys, "simulate", *options)
    assert code == 2
    assert says in err
    assert err.count("\n") == 1
    assert out == ""
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    "text",
    ["0.1\n0.2\n0.3\n", "\ufeff0.1\n0.2\n0.3\n", ",0\n0,0.1\n1,0.2\n2,0.3\n", "V\n.1\n.2\n\n.3"],
)
def test_a_potential_is_read_as_spreadsheets_write_it(tmp_path, text):
    path = tmp_path / "V.csv"
    path.write_text(text, "utf-8")
    assert read_potential(path).tolist() == [0.1, 0.2, 0.3]


@pytest.mark.parametrize("header", ["x (nm),V (ueV)", ",V (eV)", "V [µeV]", "V (V)"])
def test_a_potential_in_another_unit_is_refused(tmp_path, header):
    (tmp_path / "V.csv").write_text(f"{header}\n1,100\n2,200\n", "utf-8")
    with pytest.raises(ArgumentError, match=r"in meV per site, .* its header says "):
        read_potential(tmp_path / "V.csv")


def test_a_wire_of_another_material_is_an_option_away(monkeypatch, capsys, tmp_path):
    (tmp_path / "V.csv").write_text("0.1\n0.2\n0.3\n0.4\n")
    output = tmp_path / "wire.nc"
    wire = ["--potential", tmp_path / "V.csv", "--mass", 0.026, "--lattice", 8, "--lead-mu", 20]
    more = ["--dissipation", 0.01, "--parent-dissipation", 0, "--B", 0.5, "--bias", 0]
    code, out, _ = landscape(monkeypatch, capsys, "simulate", *wire, *more, "-o", output)
    assert code == 0
    assert out.startswith("4 sites, V from 0.1 to 0.4 meV; wrote ")
    made = xr.open_dataset(output, engine="h5netcdf")
    given = Nanowire(
        [0.1, 0.2, 0.3, 0.4], 8.0, 0.026, 8.0, lead_mu=20, dissipation=0.01, parent_dissipation=0.0
    )
    expected = conductance(given, 0.0, 0.5, 0.0)
    for name in CONDUCTANCES:
        np.testing.assert_allclose(made[name], expected[name], atol=1e-12)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[dataset]\nsites = 30\n", "it lacks the key dataset.realizations"),
        ("[dataset]\nrealisations = 3\n", "it has the unknown key dataset.realisations"),
        ("[dataset]\nrealizations = 3\nspeed = 1\n", "the unknown key dataset.speed"),
        ("[dataset]\nrealizations = -3\n", "dataset.realizations is wrong"),
        ("[dataset]\nrealizations = 3\nbias = []\n", "bias must be a non-empty"),
        ("[dataset]\nrealizations = 3\n[dataset.wire]\nlead_mu = 60\n", "within the leads' band"),
        (
            "[dataset]\nrealizations = 3\n[training]\nrealizations = 2\nnetworks = 2\n",
            "networks must be 1 where realizations is given",
        ),
        ("[dataset", "be a TOML file"),
        (None, "be a readable TOML file"),
    ],
)
@pytest.mark.parametrize("command", ["generate", "status", "train", "evaluate"])
def test_bad_configurations_are_one_sentence(monkeypatch, capsys, tmp_path, command, text, says):
    config = tmp_path / "run.toml"
    if text is not None:
        config.write_text(text)
    code, _, err = landscape(
        monkeypatch, capsys, command, "--config", config, "--build", tmp_path / "build"
    )
    assert code == 2
    assert says in err
    assert err.startswith("landscape: Argument config must")
    assert not (tmp_path / "build").exists()


@pytest.fixture
def verification(monkeypatch, capsys, tmp_path):
    """Run verify on a prediction and on measurements that simulate has written."""
    monkeypatch.chdir(tmp_path)
    settings = [*SMALL[:2], "--mu", "0.1,0.3", "--B", "0.2,0.6", "--bias=-0.03,0.01"]
    wire = ["simulate", "--seed", 3, "--components", 3, *settings]
    other = ["--barrier", "20,5", "-o", "other.nc"]
    assert landscape(monkeypatch, capsys, *wire, *other)[0] == 0
    tilted = ["--theta", 30, "--temperature", 0.04, "-o", "tilted.nc"]
    assert landscape(monkeypatch, capsys, *wire, *tilted)[0] == 0
    V = xr.load_dataset("other.nc", engine="h5netcdf")["potential"]
    data = {"potential": V, "components": ("component", np.zeros(3)), "alpha": 8.0}
    xr.Dataset(data).to_netcdf("prediction.nc", engine="h5netcdf")
    return lambda *arguments: landscape(monkeypatch, capsys, "verify", *arguments)


def test_verify_reads_what_simulate_writes(verification, tmp_path):
    tilted = xr.load_dataset("tilted.nc", engine="h5netcdf")
    assert tilted.attrs["theta"] == pytest.approx(np.pi / 6)
    other = xr.load_dataset("other.nc", engine="h5netcdf")
    assert other.attrs["barrier"].tolist() == [20, 5]
    expected = conductance(
        Nanowire(other["potential"], barrier=(20, 5)), [0.1, 0.3], [0.2, 0.6], [-0.03, 0.01]
    )
    np.testing.assert_array_equal(other["G_RL"], expected["G_RL"])
    files = ["prediction.nc", "other.nc", "tilted.nc"]
    code, out, err = verification(*files, "--controls", 19, "-o", "verified.nc")
    assert code == 0, err
    for said in (*files[1:], "G_LR", "The prediction passes: ", "wrote verified.nc"):
        assert said in out
    verified = xr.load_dataset("verified.nc", engine="h5netcdf")
    assert verified["mismatch"].max() < 1e-9  # the mean of V, 0 at --shifts, is among those tried
    assert verified["measurement"].to_numpy().tolist() == files[1:]
    assert verified.attrs["command"].startswith("landscape verify prediction.nc")


@pytest.mark.parametrize("alpha", [(1, 20), 8.0])
def test_verify_writes_what_few_samples_of_an_inversion_come_to(verification, alpha):
    """… of which α was unknown, or not, so that it is an attribute."""
    one = xr.load_dataset("prediction.nc", engine="h5netcdf")
    found = one.assign(
        potential=one["potential"].expand_dims(sample=3), potential_mean=one["potential"]
    )
    if alpha == 8.0:
        found = found.drop_vars("alpha")
    else:
        found["alpha"], found["alpha_mean"] = one["alpha"].expand_dims(sample=3), one["alpha"]
    prior = Prior(one.sizes["component"], one.sizes["site"], alpha=alpha)
    found = found.assign_attrs(alpha=8.0, prior=json.dumps(prior.to_dict()))
    found.to_netcdf("inferred.nc", engine="h5netcdf")
    code, out, err = verification("inferred.nc", "other.nc", "--controls", 19, "-o", "verified.nc")
    assert code == 0, err
    assert "Fewer than 49 samples" in out
    verified = xr.load_dataset("verified.nc", engine="h5netcdf")
    assert np.isnan(verified["p_samples"])
    assert verified["mismatch"].max() < 1e-9


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["no.nc", "other.nc"], "there is no 'no.nc'"),
        (["prediction.nc", "no.nc"], "there is no 'no.nc'"),
        (["prediction.nc", "prediction.nc"], "lacks G_LL"),
        (["other.nc", "tilted.nc"], "lacks alpha"),
        (["other.nc", "tilted.nc", "--model", "nowhere"], "Argument model must be a folder"),
        (["prediction.nc", "other.nc", "--controls", 3], "Argument controls must"),
        (["prediction.nc", "other.nc", "--noise", -1], "Argument noise must"),
        (["prediction.nc", "other.nc", "--shifts", "x"], "Argument shifts must"),
        (["prediction.nc", "other.nc", "-o", "other.nc"], "Argument output must be another file"),
    ],
)
def test_what_cannot_be_verified_is_one_sentence(verification, tmp_path, options, says):
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    code, out, err = verification(*options)
    assert code == 2
    assert says in err
    assert err.count("\n") == 1
    assert out == ""
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_training_without_a_dataset_says_what_to_run(monkeypatch, capsys, tmp_path):
    code, _, err = landscape(
        monkeypatch, capsys, "train", "--config", "configs/smoke.toml", "--build", tmp_path
    )
    assert code == 2
    assert "run `landscape generate`" in err


def test_a_folder_that_cannot_be_made_is_one_sentence(monkeypatch, capsys, tmp_path):
    (tmp_path / "file").write_text("")
    config = ["--config", "configs/smoke.toml", "--build", tmp_path / "file", "--workers", 2]
    code, _, err = landscape(monkeypatch, capsys, "generate", *config)
    assert code == 2
    assert "landscape: Argument folder must be a place to write to" in err


def test_too_little_memory_is_one_sentence(monkeypatch, capsys, tmp_path):
    def asks_for_too_much(*_, **__):
        return np.empty(10**17)

    monkeypatch.setattr("disorder_landscape.simulation.simulate_wire", asks_for_too_much)
    code, _, said = landscape(monkeypatch, capsys, "simulate", "-o", tmp_path / "wire.nc")
    assert code == 2
    assert "landscape: there is not enough memory (Unable to allocate 7" in said
    assert list(tmp_path.iterdir()) == []


def test_every_command_helps_with_an_example(monkeypatch, capsys):
    commands = sorted(typer.main.get_command(app).commands)
    assert {"simulate", "modes", "infer", "study"} <= set(commands)
    for command in commands:
        code, out, _ = landscape(monkeypatch, capsys, command, "--help")
        assert code == 0
        assert f"Example: landscape {command}" in out
    code, out, _ = landscape(monkeypatch, capsys, "--help")
    assert all(command in out for command in commands)


def test_the_command_line_does_not_import_tensorflow():
    script = (
        "import sys, disorder_landscape.cli, disorder_landscape.chain\n"
        "assert 'tensorflow' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", script], check=True)


def test_infer_writes_a_result_and_a_picture_without_the_network(monkeypatch, capsys, tmp_path):
    """On a grid that the network does not know, with a channel missing: from the prior."""
    settings = ["--seed", 3, "--sites", 300, "--mu", "0:0.6:5", "--B", "0:0.8:6", "--bias", "0"]
    wire, output, plot = tmp_path / "wire.nc", tmp_path / "out.nc", tmp_path / "out.png"
    landscape(monkeypatch, capsys, "simulate", *settings, "-o", wire)
    measured = xr.load_dataset(wire, engine="h5netcdf").drop_vars("G_RL")
    measured.to_netcdf(wire, engine="h5netcdf")
    command = ["infer", wire, "--model", shipped_model(FIVE), "-o", output, "--plot", plot]
    code, _, said = landscape(monkeypatch, capsys, *command)
    assert (code, "--from-prior" in said) == (2, True)
    code, _, said = landscape(monkeypatch, capsys, *command, "--from-prior")
    assert code in (0, None)
    result = xr.load_dataset(output, engine="h5netcdf")
    assert result.attrs["start"] == "the prior"
    assert np.isnan(result["misfit"].sel(channel="G_RL"))
    assert plot.stat().st_size > 10_000
    assert not output.with_name("out.nc.unfinished.json").exists()
    code, _, said = landscape(monkeypatch, capsys, "infer", wire, "--model", tmp_path, "-o", wire)
    assert (code, "output must be another file" in said) == (2, True)
    options = ["--model", shipped_model(FIVE), "-o", output, "--noise", "some"]
    code, _, said = landscape(monkeypatch, capsys, "infer", wire, *options)
    assert (code, said.count("\n")) == (2, 1)
    assert "noise must be one number in e²/h" in said
