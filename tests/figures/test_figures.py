"""Each figure script on a tiny preset: the files it writes and the arrays it draws, not pixels."""

from __future__ import annotations

import sys
from dataclasses import replace
from importlib import import_module
from itertools import combinations

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from scipy.constants import physical_constants

import disorder_landscape as dl
from command import Request
from disorder_landscape.arguments import ArgumentError
from disorder_landscape.config import WireConfig
from disorder_landscape.model.disorder import cosine_components
from disorder_landscape.runs import FIVE, TEN, preset_run
from disorder_landscape.solver.compiled import core
from disorder_panels import disorder_data
from plotting import COLUMN, FULL_WIDTH, paper_style
from wires import simulate_rows

SCRIPTS = {
    "figure_1": "figure_1_network",
    "figure_2": "figure_2_scaling",
    "figure_3": "figure_3_conductance_bias",
    "figure_4": "figure_4_disorder",
    "figure_5": "figure_5_alpha",
    "figure_S1": "figure_S1_device",
    "figure_S2": "figure_S2_network_width",
    "figure_S3": "figure_S3_components",
    "figure_S4": "figure_S4_ten_components",
    "figure_S5": "figure_S5_conductance_mu",
    "figure_S6": "figure_S6_conductance_mu_ten",
    "figure_S7": "figure_S7_visibility",
    "figure_S8": "figure_S8_visibility_ten",
    "figure_S9": "figure_S9_pristine",
    "figure_S10": "figure_S10_verification",
    "figure_S11": "figure_S11_learning_curves",
    "figure_S12": "figure_S12_inversion",
    "figure_S13": "figure_S13_inside",
}
CONDUCTANCES = ("G_LL", "G_RR", "G_LR", "G_RL")


@pytest.fixture(scope="module")
def request_(evaluation_file) -> Request:
    return Request(preset_run("smoke"), evaluation_file)


@pytest.fixture(scope="module")
def drawn(request_):
    """Data of a figure, made once."""
    cache: dict[str, xr.Dataset] = {}

    def data(figure: str) -> xr.Dataset:
        if figure not in cache:
            cache[figure] = import_module(SCRIPTS[figure]).data(request_)
        return cache[figure]

    return data


def draw(figure: str, data: xr.Dataset) -> Figure:
    with paper_style():
        return import_module(SCRIPTS[figure]).draw(data)


def wires(evaluation: xr.Dataset, i: int) -> list[dl.Nanowire]:
    """Input and prediction of a realization."""
    return [
        dl.Nanowire(
            evaluation[f"potential{end}"][i].to_numpy(), alpha=float(evaluation[f"alpha{end}"][i])
        )
        for end in ("", "_predicted")
    ]


@pytest.mark.parametrize("figure", SCRIPTS)
def test_a_script_writes_pdf_png_and_the_arrays(figure, evaluation_file, tmp_path, capsys):
    arguments = ["--preset", "smoke", "--evaluation", evaluation_file, "--output", tmp_path]
    import_module(SCRIPTS[figure]).main([str(argument) for argument in arguments])
    written = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert set(written) == {f"{figure}.pdf", f"{figure}.png", f"{figure}.nc"}
    assert written[f"{figure}.pdf"].startswith(b"%PDF")
    assert written[f"{figure}.png"].startswith(b"\x89PNG")
    stored = xr.load_dataset(tmp_path / f"{figure}.nc", engine="h5netcdf")
    script = f"{SCRIPTS[figure]}.py"
    drawn_from = f"--preset smoke --evaluation {evaluation_file}"
    assert stored.attrs["command"] == f"python paper_figures/{script} {drawn_from}"
    assert figure in capsys.readouterr().out


@pytest.mark.parametrize("figure", SCRIPTS)
def test_text_is_legible_at_print_width_and_within_the_page(figure, drawn):
    drawing = draw(figure, drawn(figure))
    assert drawing.get_figwidth() in (COLUMN, FULL_WIDTH)
    with paper_style():
        FigureCanvasAgg(drawing).draw()
        hidden = _ticks_out_of_view(drawing)
        texts = [t for t in drawing.findobj(Text) if t.get_visible() and t.get_text().strip()]
        texts = [text for text in texts if text not in hidden]
        boxes = [text.get_window_extent() for text in texts]
    page = drawing.bbox
    for text, box in zip(texts, boxes, strict=True):
        assert text.get_fontsize() >= 8, text.get_text()
        assert page.x0 <= box.x0 <= box.x1 <= page.x1, text.get_text()
        assert page.y0 <= box.y0 <= box.y1 <= page.y1, text.get_text()
    for (one, box), (other, another) in combinations(zip(texts, boxes, strict=True), 2):
        x = min(box.x1, another.x1) - max(box.x0, another.x0)
        y = min(box.y1, another.y1) - max(box.y0, another.y0)
        assert min(x, y) < 3, (one.get_text(), other.get_text())  # dots of 1/300 inch


def _ticks_out_of_view(figure: Figure) -> set[Text]:
    """Tick labels that exist but are not drawn."""
    return {
        tick.label1
        for axes in figure.axes
        for axis in (axes.xaxis, axes.yaxis)
        for tick in axis.get_major_ticks()
        if not min(axis.get_view_interval()) <= tick.get_loc() <= max(axis.get_view_interval())
    }


def test_the_same_data_give_the_same_bytes(evaluation_file, tmp_path):
    main = import_module(SCRIPTS["figure_4"]).main
    for folder in ("one", "two"):
        arguments = ["--preset", "smoke", "--evaluation", evaluation_file]
        main([str(a) for a in [*arguments, "--output", tmp_path / folder]])
    for ending in ("pdf", "png"):
        one, two = (tmp_path / folder / f"figure_4.{ending}" for folder in ("one", "two"))
        assert one.read_bytes() == two.read_bytes()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--preset", "nonesuch"], "preset"),
        (["--preset", "smoke", "--evaluation", "nonesuch.nc"], "nonesuch.nc"),
    ],
)
def test_bad_input_is_one_sentence_and_writes_nothing(options, said, tmp_path, capsys):
    with pytest.raises(SystemExit) as exit_:
        import_module(SCRIPTS["figure_4"]).main([*options, "--output", str(tmp_path)])
    assert exit_.value.code == 2
    message = capsys.readouterr().err
    assert "Argument " in message
    assert said in message
    assert message.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_realization_that_is_not_there_is_refused(config, evaluation_file):
    figures = config.figures.model_copy(update={"realizations": (0, 99)})
    run = replace(preset_run("smoke"), config=config.model_copy(update={"figures": figures}))
    beyond = Request(run, evaluation_file)
    with pytest.raises(ArgumentError, match="realizations must"):
        import_module(SCRIPTS["figure_4"]).data(beyond)


@pytest.mark.parametrize(("figure", "y"), [("figure_3", "bias"), ("figure_S5", "mu")])
def test_conductances_are_the_simulated_wires(figure, y, drawn, evaluation, config):
    data = drawn(figure)
    y_points = {"bias": config.figures.bias_points, "mu": config.figures.mu_points}[y]
    assert data["row"].to_numpy().tolist() == ["input", "prediction"]
    for i, pair in enumerate(wires(evaluation, i) for i in config.figures.realizations):
        for row, wire in enumerate(pair):
            G = dl.conductance(
                wire,
                mu=data["mu"].to_numpy() if y == "mu" else 0.0,
                B=data["B"].to_numpy(),
                bias=data["bias"].to_numpy() if y == "bias" else 0.0,
                temperature=config.dataset.temperature,
            ).squeeze()
            for name in CONDUCTANCES:
                here = data[name][i, row].transpose("B", y)
                assert here.shape == (config.figures.B_points, y_points)
                np.testing.assert_allclose(here, G[name].transpose("B", y), atol=1e-12)
            assert data["alpha"][i, row] == wire.alpha
    assert (data[["G_LL", "G_RR"]].to_dataarray() >= 0).all()
    assert data["B"][0] == 0
    assert data["B"][-1] == config.dataset.B_max


def test_nonlocal_conductances_agree_at_zero_bias(drawn):
    """Thermal averages at V = 0 are even in ω, and particle-hole symmetry does the rest."""
    data = drawn("figure_S5")
    np.testing.assert_allclose(data["G_LR"], data["G_RL"], atol=2 * core.TOLERANCE)


@pytest.mark.parametrize("figure", ["figure_3", "figure_S5"])
def test_input_and_prediction_share_one_norm(figure, drawn):
    data = drawn(figure)
    meshes = [axes.collections[0] for axes in draw(figure, data).axes if _is_map(axes)]
    assert len(meshes) == data.sizes["realization"] * 2 * 4
    for i, block in enumerate(np.array(meshes).reshape(-1, 2, 4)):
        for column, name in enumerate(CONDUCTANCES):
            above, below = block[:, column]
            G = data[name][i]
            assert (above.norm.vmin, above.norm.vmax) == (below.norm.vmin, below.norm.vmax)
            assert above.get_cmap() == below.get_cmap()
            if name in ("G_LL", "G_RR"):
                assert above.norm.vmin == 0
                assert above.norm.vmax >= float(G.max())
            else:
                assert above.norm.vmin == -above.norm.vmax
            for row, mesh in enumerate((above, below)):
                plotted = np.sort(np.asarray(mesh.get_array()).ravel())
                np.testing.assert_array_equal(plotted, np.sort(G[row].to_numpy().ravel()))


def _is_map(axes) -> bool:
    return axes.get_label() in (*CONDUCTANCES, "T_IV")  # colour bars have meshes too


def test_visibility_is_of_the_wires_and_within_its_range(drawn, evaluation, config):
    data = drawn("figure_S7")
    assert (abs(data["T_IV"]) <= 1 + 1e-9).all()
    mu, B = data["mu"].to_numpy(), data["B"].to_numpy()
    assert (mu.size, B.size) == (config.figures.mu_points, config.figures.B_points)
    for i, pair in enumerate(wires(evaluation, i) for i in config.figures.realizations):
        for row, wire in enumerate(pair):
            T_IV = dl.topological_visibility(wire, mu, B)
            for lead in "LR":  # both ends see the same
                np.testing.assert_allclose(data["T_IV"][i, row], T_IV.sel(lead=lead), atol=1e-6)
    norms = [axes.collections[0].norm for axes in draw("figure_S7", data).axes if _is_map(axes)]
    assert len(norms) == 2 * len(config.figures.realizations)
    assert all((norm.vmin, norm.vmax) == (-1, 1) for norm in norms)


def test_potentials_are_the_components_plus_barriers(drawn, evaluation, config):
    data = drawn("figure_4")
    chosen = evaluation.isel(realization=list(config.figures.realizations))
    for row, end in enumerate(("", "_predicted")):
        np.testing.assert_array_equal(data["components"][:, row], chosen[f"components{end}"])
        bare = data["potential"][:, row].to_numpy().copy()
        bare[:, [0, -1]] -= 15.0  # meV, the paper's barriers
        np.testing.assert_allclose(bare, chosen[f"potential{end}"], atol=1e-12)
        n = data.sizes["component"]
        np.testing.assert_allclose(
            cosine_components(bare)[:, 1 : n + 1], data["components"][:, row], atol=1e-12
        )
    sites = config.dataset.sites
    np.testing.assert_allclose(data["x"], 0.01 * (np.arange(sites) + 0.5))  # µm


def test_wires_are_drawn_with_the_barriers_and_leads_of_their_dataset(evaluation):
    fixed, chosen = WireConfig(barrier=30.0, lead_mu=20.0), evaluation.isel(realization=[1])
    simulated = []

    def simulate(wire):
        simulated.append(wire)
        return xr.Dataset({"sites": wire.sites})

    simulate_rows(chosen, fixed, simulate)
    assert [(one.barrier, one.lead_mu) for one in simulated] == 2 * [((30.0, 30.0), 20.0)]
    drawn = disorder_data(chosen, fixed)
    ends = drawn["potential"][0, 0, [0, -1]] - chosen["potential"][0, [0, -1]]
    np.testing.assert_allclose(ends, 30.0)
    assert drawn.attrs["barrier"] == 30.0


def test_alpha_is_drawn_as_predicted_with_its_error(drawn, evaluation):
    data = drawn("figure_5")
    error = (evaluation["alpha_predicted"] - evaluation["alpha"]).to_numpy()
    assert data.attrs["delta_alpha"] == pytest.approx(np.std(error))
    samples, scatter = draw("figure_5", data).axes
    by_label = {line.get_label(): line for line in samples.lines}
    np.testing.assert_array_equal(by_label["input"].get_ydata(), evaluation["alpha"])
    np.testing.assert_array_equal(by_label["prediction"].get_ydata(), evaluation["alpha_predicted"])
    diagonal, points = scatter.lines
    np.testing.assert_array_equal(diagonal.get_xdata(), diagonal.get_ydata())
    np.testing.assert_array_equal(points.get_xdata(), evaluation["alpha"])
    np.testing.assert_array_equal(points.get_ydata(), evaluation["alpha_predicted"])
    assert f"{data.attrs['delta_alpha']:.3f}" in scatter.texts[0].get_text()


def test_verifications_are_of_the_wires_that_are_drawn(drawn, evaluation, config):
    data = drawn("figure_S10")
    shown = len(config.figures.realizations)
    assert data["ratio"].shape == (shown, 4)
    assert data["wrong_ratio"].shape == (shown, config.figures.verification_controls, 4)
    np.testing.assert_allclose((data["wrong_ratio"] ** 2).median("control"), 1.0, atol=0.6)
    assert (data["ratio"].mean() < data["wrong_ratio"].mean("control")).all()  # small changes
    pair = wires(evaluation, config.figures.realizations[0])
    for row, wire in enumerate(pair):
        G = dl.conductance(
            replace(wire, barrier=tuple(data.attrs["barriers"])),
            mu=0.0,
            B=data["B"].to_numpy(),
            bias=data["bias"].to_numpy(),
            temperature=config.dataset.temperature,
            theta=np.radians(data.attrs["theta"]),
        ).squeeze()
        for name in CONDUCTANCES:
            np.testing.assert_allclose(data[name][row], G[name], atol=1e-12)
    maps = [axes.collections[0] for axes in draw("figure_S10", data).axes if _is_map(axes)]
    for column in np.array(maps).reshape(3, 4).T:
        assert len({(mesh.norm.vmin, mesh.norm.vmax) for mesh in column}) == 1


def test_the_network_is_the_papers():
    """Layers, kernels, filters and pools of Fig. 1 and S-II.2, read from the Keras model."""
    data = import_module(SCRIPTS["figure_1"]).data(Request(preset_run("paper")))
    kind = data["kind"].to_numpy()
    convolutions = np.char.startswith(kind.astype(str), "Conv")
    kernels = [[int(n) for n in row if n] for row in data["kernel"].to_numpy()[convolutions]]
    assert kernels == [[5] * 3] + [[3] * 3] * 4 + [[3] * 2] * 4
    filters = [[int(n) for n in row if n][-1] for row in data["shape"].to_numpy()[convolutions]]
    assert filters == [256] * 2 + [512] * 3 + [1028] * 4
    pools = data["pool"].to_numpy()[np.char.startswith(kind.astype(str), "MaxPooling")]
    assert [[int(n) for n in row if n] for row in pools] == [[2] * 3, [2] * 3, [2] * 2]
    assert (kind == "BatchNormalization").sum() == 3
    assert data["shape"].to_numpy()[kind == "Dense", 0].tolist() == [500, 500, 6]
    assert data["label"].to_numpy().tolist() == ["c_1", "c_2", "c_3", "c_4", "c_5", "alpha"]
    assert data["shape"].to_numpy()[0].tolist() == [15, 15, 5, 4]
    texts = {text.get_text() for text in draw("figure_1", data).findobj(Text)}
    assert {"5×5×5", "256 filters", "512 filters", "1028 filters", "15×15×5"} <= texts


def test_the_device_is_the_papers(drawn):
    data = drawn("figure_S1")
    assert data["length"] == pytest.approx(3.0)
    assert data["barrier"].to_numpy().tolist() == [15.0, 15.0]


@pytest.mark.parametrize(
    ("mu", "B", "T_IV"),
    [(0, 0, 1.0), (0, 0.3, -1.0), (0, 0.5, -0.9979), (0.3, 0.3, 1.0), (0.3, 0.6, -0.3367)],
)
def test_the_pristine_visibility_has_the_known_values(mu, B, T_IV, drawn):
    point = drawn("figure_S9")["T_IV"].sel(mu_a=mu, B_a=B, method="nearest", tolerance=1e-9)
    assert float(point) == pytest.approx(T_IV, abs=1e-4)


def test_the_pristine_transition_is_where_zeeman_meets_mu_and_gamma(drawn):
    """V_Z² = μ² + γ², and B_c = 0.207 T at μ = 0."""
    data = drawn("figure_S9")
    mu_B = 1e3 * physical_constants["Bohr magneton in eV/T"][0]
    V_Z = 0.5 * 25 * mu_B * data["transition"]
    np.testing.assert_allclose(V_Z**2, data["mu_a"] ** 2 + 0.15**2)
    assert float(data["transition"][0]) == pytest.approx(0.207, abs=1e-3)
    line = draw("figure_S9", data).axes[0].lines[0]
    np.testing.assert_array_equal(line.get_xdata(), data["transition"])
    np.testing.assert_array_equal(line.get_ydata(), data["mu_a"])


def test_the_pristine_conductances_are_simulated_and_mirror_symmetric(drawn, config):
    data = drawn("figure_S9")
    wire = dl.Nanowire(np.zeros(300), alpha=8.0)
    B = data["B"].to_numpy()
    grids = {"b": (data["mu"], 0.0), "c": (0.0, data["bias"]), "d": (0.3, data["bias"])}
    for letter, (mu, bias) in grids.items():
        G = dl.conductance(wire, mu, B, bias).squeeze()
        for name in CONDUCTANCES:
            drawn_map = data[f"{name}_{letter}"]
            np.testing.assert_allclose(drawn_map, G[name].transpose(*drawn_map.dims), atol=1e-12)
        for one, other in (("G_LL", "G_RR"), ("G_LR", "G_RL")):
            np.testing.assert_allclose(
                data[f"{one}_{letter}"], data[f"{other}_{letter}"], atol=2 * core.TOLERANCE
            )


def test_the_stated_numbers_of_components(drawn):
    """S-II.3: 54 for F = 0.95 at ℓ = 3, 29 and 33 for F = 0.95 and 0.97 at ℓ = 7."""
    required = drawn("figure_S3")["components"].sel(sites=300)
    stated = {(3, 0.95): 54, (7, 0.95): 29, (7, 0.97): 33}
    for (length, fidelity), n in stated.items():
        assert int(required.sel(correlation_length=length, fidelity=fidelity)) == n


def test_longer_and_rougher_wires_need_more_components(drawn):
    required = drawn("figure_S3")["components"]
    assert (required.diff("sites") > 0).all()
    assert (required.diff("fidelity") > 0).all()
    assert (required.diff("correlation_length") <= 0).all()


@pytest.mark.parametrize("figure", SCRIPTS)
def test_each_figure_shows_wires_of_its_model(figure, monkeypatch):
    """S4, S6 and S8 those of ten components, the others of five and α."""
    asked, module = {}, import_module(SCRIPTS[figure])
    monkeypatch.setattr(module, "figure_script", lambda *_, **options: asked.update(options))
    module.main([])
    is_of_ten = figure in ("figure_S4", "figure_S6", "figure_S8")
    assert asked.get("model", FIVE) == (TEN if is_of_ten else FIVE)


def test_a_preset_that_is_none_is_one_sentence_before_all_figures(capsys, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["estimate.py", "--preset", "large"])
    with pytest.raises(SystemExit) as stop:
        import_module("estimate").main()
    said = capsys.readouterr().err
    assert (stop.value.code, said.count("\n")) == (2, 1)
    assert said.startswith("estimate.py: Argument preset must be one of full, noisy, paper, ")


def test_ten_components_are_drawn_like_five(drawn):
    """Figures S4, S6 and S8 show what Figures 3, 4, S5 and S7 show, of the other model's wires."""
    ten = drawn("figure_S4")
    for figure in ("figure_3", "figure_4"):
        for name, values in drawn(figure).data_vars.items():
            np.testing.assert_array_equal(ten[name], values)
    assert drawn("figure_S6").identical(drawn("figure_S5"))
    assert drawn("figure_S8").identical(drawn("figure_S7"))
