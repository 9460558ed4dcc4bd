"""Errors beside the noise: found where there are any, and nothing where there are none."""

import numpy as np
import pytest
import xarray as xr

import disorder_landscape as dl
from disorder_landscape import conductance
from disorder_landscape.config import Config, DatasetConfig
from disorder_landscape.dataset.realizations import realization
from disorder_landscape.inference import discrepancy
from disorder_landscape.inference.report import sentences_on, summary
from disorder_landscape.inference.search.few_unknowns import InversionSettings
from disorder_landscape.inference.search.regression_rounds import RoundSettings
from disorder_landscape.inference.verdict import CONVERGED, NOT_DESCRIBED
from disorder_landscape.learning.model import TrainedModel
from disorder_landscape.learning.scaling import LabelScaler
from disorder_landscape.model.quantities import CONDUCTANCES

DATASET = DatasetConfig(
    realizations=1, components=1, sites=40, mu_points=7, B_points=7, bias=(-0.03, 0.0, 0.03)
)
LABELS = LabelScaler(("c_1", "alpha"), np.zeros(2), np.ones(2))
MODEL = TrainedModel(None, LABELS, None, Config(dataset=DATASET))
TRUE = realization(DATASET, 1)
STATED = 0.001
MORE = {"G_LL": 0.01, "G_RR": 0.01, "G_LR": 0.002, "G_RL": 0.002}
"""Errors in truth, in e²/h."""
SOON = InversionSettings(attempts=2, rounds=RoundSettings(rounds=2))


@pytest.fixture(scope="module")
def measured():
    G = conductance(TRUE.wire, DATASET.mu, DATASET.B, DATASET.bias)
    rng = np.random.default_rng(1)
    return G.assign({name: G[name] + MORE[name] * rng.normal(size=G[name].shape) for name in MORE})


def infer(G, noise=STATED, **options):
    return dl.infer(G, MODEL, noise, network=False, samples=8, settings=SOON, **options)


@pytest.fixture(scope="module")
def steps():
    """Of the inversion of the next fixture."""
    return []


@pytest.fixture(scope="module")
def allowed(measured, steps):
    return infer(measured, discrepancy=True, progress=steps.append)


@pytest.fixture(scope="module")
def known(measured):
    return infer(measured, noise=MORE)


def test_the_errors_beside_the_noise_are_found(allowed):
    expected = [np.sqrt(MORE[name] ** 2 - STATED**2) for name in CONDUCTANCES]
    np.testing.assert_allclose(allowed["discrepancy"], expected, rtol=0.2)  # of 147 data each
    assert allowed["discrepancy"].attrs["units"] == "e²/h"


def test_the_answer_is_that_with_all_errors_stated(known, allowed):
    assert known.attrs["verdict"] == CONVERGED
    bars = known["potential_std"]
    np.testing.assert_allclose(allowed["potential_std"], bars, rtol=0.2)
    assert float(abs(allowed["potential_mean"] - known["potential_mean"]).max()) < 0.5 * bars.max()


def test_the_verdict_is_that_by_the_stated_noise(measured, allowed):
    without = infer(measured)
    assert "discrepancy" not in without
    assert without.attrs["verdict"] == allowed.attrs["verdict"] == NOT_DESCRIBED
    assert allowed.attrs["excess"] == pytest.approx(without.attrs["excess"], rel=0.1)
    assert allowed.attrs["noise"].tolist() == [STATED] * 4
    assert float(allowed["potential_std"].mean()) > 1.5 * float(without["potential_std"].mean())


def test_words_say_how_large_they_are(allowed):
    said = "Errors beside the noise are allowed for, in e²/h: G_LL 0.0"
    assert sentences_on(allowed)[1].startswith(said)
    assert any(line.startswith(said) for line in summary(allowed))


def test_it_says_whether_they_have_settled(measured, allowed, monkeypatch):
    assert allowed["discrepancy"].attrs["settled"] == 1
    assert all("settled" not in sentence for sentence in sentences_on(allowed))
    monkeypatch.setattr(discrepancy, "TURNS", 1)
    cut_short = infer(measured, discrepancy=True)
    assert cut_short["discrepancy"].attrs["settled"] == 0
    assert "They have not settled" in sentences_on(cut_short)[1]


def test_data_that_the_noise_explains_have_none(measured, known):
    allowing = infer(measured, noise=MORE, discrepancy=True)
    assert np.all(allowing["discrepancy"] == 0)
    xr.testing.assert_identical(allowing.drop_vars("discrepancy"), known)
    assert all("beside the noise" not in sentence for sentence in sentences_on(allowing))


def test_a_channel_that_was_not_measured_has_none(measured):
    some = infer(measured.drop_vars("G_RL"), discrepancy=True)
    assert np.isnan(some["discrepancy"].sel(channel="G_RL"))
    assert float(some["discrepancy"].sel(channel="G_LL")) == pytest.approx(0.01, rel=0.2)


def test_an_interrupted_run_goes_on(measured, allowed, steps, tmp_path):
    """The last steps but the maps are those of the best effort."""
    path, left = tmp_path / "unfinished.json", iter(range(len(steps) - 3))

    def interrupt(step):
        if next(left, None) is None:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        infer(measured, discrepancy=True, progress=interrupt, checkpoint=path)
    left_to_do = []
    again = infer(measured, discrepancy=True, checkpoint=path, progress=left_to_do.append)
    xr.testing.assert_identical(again, allowed)
    assert sum(step.stage == "round" for step in left_to_do) == sum(
        step.stage == "round" for step in steps
    )
    assert len(left_to_do) < len(steps) / 2


def test_only_a_truth_value_is_taken(measured):
    with pytest.raises(dl.ArgumentError, match="discrepancy must be True or False"):
        infer(measured, discrepancy=0.01)
