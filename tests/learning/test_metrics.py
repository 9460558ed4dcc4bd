"""R², ΔV_dis(x_i) and Δα against values worked out by hand."""

from __future__ import annotations

import json

import numpy as np
import pytest

from disorder_landscape.learning.metrics import Scores, score
from disorder_landscape.learning.scaling import LabelScaler

Y = np.array([[1.0, 6.4], [2.0, 8.0], [3.0, 9.6]])  # c_1 in meV, alpha in meV nm
SCALER = LabelScaler(("c_1", "alpha"), Y.mean(axis=0), Y.std(axis=0))


def test_perfect_prediction():
    scores = score(Y, Y, SCALER, sites=4)
    assert (scores.r2, scores.delta_V, scores.delta_alpha) == (1, 0, 0)


def test_predicting_the_average_scores_zero():
    average = np.broadcast_to(Y.mean(axis=0), Y.shape)
    assert score(Y, average, SCALER, sites=4).r2 == pytest.approx(0)


def test_values_by_hand():
    error = np.array([[0.3, 0.4], [0.0, -0.8], [-0.3, 0.4]])
    scores = score(Y, Y + error, SCALER, sites=4)
    # c_1: 1 − (0.09 + 0 + 0.09)/(1 + 0 + 1); alpha: 1 − (0.16 + 0.64 + 0.16)/(2 · 1.6²)
    assert scores.r2_by_label == pytest.approx({"c_1": 0.91, "alpha": 0.8125})
    assert scores.r2 == pytest.approx((0.91 + 0.8125) / 2)
    # φ₁ is normalised, so that the mean square over the four sites is c²/4.
    assert scores.delta_V == pytest.approx(np.sqrt((0.09 + 0 + 0.09) / 3 / 4))
    assert scores.delta_alpha == pytest.approx(np.sqrt((0.16 + 0.64 + 0.16) / 3))
    assert scores.realizations == 3


def test_without_alpha():
    scaler = LabelScaler(("c_1",), np.zeros(1), np.ones(1))
    scores = score(Y[:, :1], Y[:, :1] + 0.1, scaler, sites=4)
    assert scores.delta_alpha is None
    assert list(scores.r2_by_label) == ["c_1"]


def test_scores_survive_json():
    scores = score(Y, Y * 1.01, SCALER, sites=4)
    assert Scores.from_dict(json.loads(json.dumps(scores.to_dict()))) == scores


def test_the_mean_of_the_potential_is_scored_apart():
    names = ("c_1", "alpha", "mean")
    Y3 = np.column_stack([Y, [0.01, 0.0, -0.01]])
    scaler = LabelScaler(names, Y3.mean(axis=0), Y3.std(axis=0))
    scores = score(Y3, Y3 + [[0.0, 0.0, 0.01]] * 3 * np.array([[1], [-1], [0]]), scaler, sites=4)
    assert (scores.r2, scores.delta_V) == (1, 0)
    assert scores.r2_by_label["mean"] == pytest.approx(1 - 2 / 2)
    assert scores.delta_mean == pytest.approx(0.01 * np.sqrt(2 / 3))
