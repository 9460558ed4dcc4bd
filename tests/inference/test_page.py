"""The page and the picture of a result, of a measurement with a gate axis and an unknown g."""

import re

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

import disorder_landscape as dl
from disorder_landscape.inference.page import page
from disorder_landscape.inference.plot import _potential, plot_inference
from disorder_landscape.inference.plot_maps import (
    draw_conductances,
    draw_maps,
    measured_channels,
    sure_gap,
)
from disorder_landscape.inference.problem.measured_dataset import measurement_of
from disorder_landscape.inference.problem.measurement import PAPERS_SETTINGS
from disorder_landscape.inference.report import sentences_on, topological_sentence, verdict_sentence
from disorder_landscape.inference.verdict import NOT_CONVERGED, NOT_DESCRIBED
from disorder_landscape.model.quantities import CONDUCTANCES

PRIOR = dl.Prior(components=1, sites=50, g=(23.0, 27.0), lever_arm=0.5)
NOISE = 0.002


@pytest.fixture(scope="module")
def measured():
    gate, B, bias = np.linspace(0, 1.2, 5), np.linspace(0, 0.8, 5), np.array([-0.03, 0.0, 0.03])
    made = dl.conductance(dl.Nanowire(potential=np.zeros(50)), gate / 2, B, bias)
    rng = np.random.default_rng(0)
    shape = (gate.size, B.size, bias.size)
    arrays = {
        name: (("gate", "B", "bias"), made[name].to_numpy() + NOISE * rng.normal(size=shape))
        for name in CONDUCTANCES
    }
    return xr.Dataset(arrays, {"gate": gate, "B": B, "bias": bias})


@pytest.fixture(scope="module")
def result(measured):
    return dl.infer(measured, PRIOR, noise=NOISE, samples=16)


@pytest.mark.parametrize("ending", [".html", ".png", ".pdf"])
def test_a_result_is_drawn_in_each_format(result, measured, tmp_path, ending):
    path = tmp_path / f"drawn{ending}"
    plot_inference(result, measurement_of(measured, PAPERS_SETTINGS), path)
    begins = {".html": b"<!doctype html>", ".png": b"\x89PNG", ".pdf": b"%PDF"}
    assert path.read_bytes().startswith(begins[ending])
    assert [one.name for one in tmp_path.iterdir()] == [path.name]


def test_several_maxima_are_drawn(result):
    """The first few with their shares, all with their potentials."""
    one = result["potential_maxima"][0].to_numpy()
    several = result.drop_dims("maximum").assign(
        share=("maximum", [0.4, 0.3, 0.1, 0.1, 0.05]),
        potential_maxima=(("maximum", "site"), np.stack([k * one for k in range(5)])),
    )
    panel = Figure().subplots()
    _potential(panel, several)
    assert len(panel.lines) == 1 + 5
    labels = [text.get_text() for text in panel.get_legend().get_texts()]
    assert labels == ["40 %", "30 %", "10 %", "10 %"]
    assert "5 wires explain the data within their noise, with 40, 30, 10" in verdict_sentence(
        several
    )


def test_one_conductance_alone_is_drawn(result, measured, tmp_path):
    shown = measurement_of(measured[["G_RL"]], PAPERS_SETTINGS)
    plot_inference(result, shown, tmp_path / "drawn.png")
    assert measured_channels(shown) == [3]


def test_a_page_says_what_was_found(result):
    text = page(result, Figure())
    assert verdict_sentence(result) in text
    assert 'class="verdict converged"' in text
    assert re.search(
        r"<td>Landé g-factor \(g\)</td><td>23 to 27</td><td>2\d\.\d+ ± 0\.\d+</td>", text
    )
    for name in CONDUCTANCES:
        assert f"<td>{name}</td>" in text
    assert text.count("<table>") == text.count("</table>") == 3
    assert "<script" not in text
    assert "http" not in text


def test_what_a_result_says_is_no_html(result):
    named = result.assign_attrs(start="<b>me & you</b>")
    assert "&lt;b&gt;me &amp; you&lt;/b&gt;" in page(named, Figure())


@pytest.mark.parametrize("verdict", [NOT_CONVERGED, NOT_DESCRIBED])
def test_other_verdicts_say_what_not_to_trust(result, verdict):
    doubtful = result.assign_attrs(verdict=verdict)
    (said,) = sentences_on(doubtful)
    assert said.startswith(f"{verdict.capitalize()}: ")
    assert "to be trusted" in said
    assert 'class="verdict doubtful"' in page(doubtful, Figure())


def test_topological_shares_are_of_the_range(result):
    P = xr.zeros_like(result["P_topological"])

    def said():
        return topological_sentence(result.assign(P_topological=P))

    assert "nowhere in the measured gate voltages and B" in said()
    P[: P.shape[0] // 2] = 0.5
    assert "in 0 % of" in said()
    assert "49 % more" in said()
    P[0, 0] = 1.0
    assert "in less than 1 % of" in said()
    P[:] = 1.0
    assert "in 100 % of" in said()


def test_a_bias_without_data_is_not_drawn(result, measured, tmp_path):
    gaps = measured.copy(deep=True)
    gaps["G_LL"][:, :, 1] = np.nan
    path = tmp_path / "drawn.svg"
    plot_inference(result, measurement_of(gaps, PAPERS_SETTINGS), path)
    assert "-0.03 meV" in path.read_text().replace("\N{MINUS SIGN}", "-")


BIAS, AT_NO_BIAS = r"$V_\mathrm{bias}$ [meV]", r"at $V_\mathrm{bias}$ = 0 meV"
ONE_GATE, ONE_FIELD = {"gate": [2], "map_gate": [2]}, {"B": [2], "map_B": [2]}
ONE_BIAS = {"bias": [1]}


@pytest.mark.parametrize(
    ("at", "axes", "title", "maps"),
    [
        ({}, ("gate", "$B$ [T]"), AT_NO_BIAS, 9),
        (ONE_GATE, (BIAS, "$B$ [T]"), "at gate = 0.6", 6),
        (ONE_FIELD, (BIAS, "gate"), "at $B$ = 0.4 T", 6),
        (ONE_GATE | ONE_BIAS, ("$e^2/h$", "$B$ [T]"), AT_NO_BIAS, 0),
        (ONE_FIELD | ONE_BIAS, ("$e^2/h$", "gate"), AT_NO_BIAS, 0),
        (ONE_GATE | ONE_FIELD, ("$e^2/h$", BIAS), "at gate = 0.6", 0),
        (ONE_GATE | ONE_FIELD | ONE_BIAS, ("$e^2/h$", "gate"), AT_NO_BIAS, 0),
    ],
)
def test_maps_are_over_the_axes_of_more_than_one_value(result, measured, at, axes, title, maps):
    """… or curves, where there is one such axis."""
    of_data = {axis: where for axis, where in at.items() if not axis.startswith("map_")}
    figure = Figure()
    panels = dict(
        zip(
            ("measured", "explained", "residual", *CONDUCTANCES[1:], "T", "P", "gap"),
            figure.subplots(3, 3).ravel(),
            strict=True,
        )
    )
    shown = measurement_of(measured.isel(of_data), PAPERS_SETTINGS)
    draw_conductances(figure, panels, result.isel(at), shown)
    draw_maps(figure, panels, result.isel(at), shown)
    assert (panels["measured"].get_ylabel(), panels["measured"].get_xlabel()) == axes
    assert title in panels["measured"].get_title()
    for name in CONDUCTANCES[1:]:
        assert panels[name].get_title().endswith("measured − explained")
    assert sum(bool(panel.collections) for panel in panels.values()) == maps
    dots = panels["P"].lines[-1]
    over = shown.B if panels["P"].get_xlabel() == "$B$ [T]" else shown.mu
    assert set(dots.get_xdata()) <= set(over)
    assert dots.get_xdata().size == shown.mu.size * shown.B.size


def test_the_sure_gap_is_what_nineteen_of_twenty_samples_exceed():
    P_gap = np.array([1.0, 0.96, 0.94, 0.2])[:, None, None]
    made = xr.Dataset({"P_gap": (("gap", "mu", "B"), P_gap)}, {"gap": [0.0, 0.1, 0.2, 0.3]})
    np.testing.assert_array_equal(sure_gap(made), [[0.1]])
    np.testing.assert_array_equal(sure_gap(made.assign(P_gap=0 * made["P_gap"])), [[0.0]])
