"""The study of hot and cold wires, in small."""

import numpy as np
import pytest

from disorder_landscape.studies.study import Place
from disorder_landscape.studies.temperatures import TemperaturesPlan, _around, _maps

PLAN = TemperaturesPlan(
    kind="temperatures", title="", cold=0.02, hot=(0.02, 0.3), wires=8, seed=1, points=7
)


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    return Place(*(tmp_path_factory.mktemp(name) for name in ("output", "build")))


@pytest.fixture(scope="module")
def table(place):
    return [row for task in PLAN.tasks() for row in PLAN.rows(task, place)]


def test_what_is_as_cold_is_told_and_what_is_hot_is_not(table):
    same, hot = table
    for name in ("local", "nonlocal"):
        assert same[f"correlation_{name}"] == same[f"strength_{name}"] == 1.0
        assert hot[f"correlation_{name}"] < 1
        assert hot[f"strength_{name}"] < 1
        assert hot[f"r2_{name}"] < same[f"r2_{name}"]
    assert same["r2_local"] > 0.5


def test_each_point_sees_its_neighbours():
    config = PLAN.config(0.02)
    maps = _maps(config)
    seen = _around(config, maps)
    assert seen.shape == (8, 7, 7, 9 * maps.shape[3] * maps.shape[4] + 2)
    of_point = maps[2, 3, 4].ravel()
    neighbours = seen[2, 3, 4, :-2].reshape(of_point.size, 9)
    np.testing.assert_array_equal(neighbours[:, 4], of_point)
    np.testing.assert_array_equal(neighbours[:, 5], maps[2, 3, 5].ravel())
    np.testing.assert_array_equal(seen[2, 3, 4, -2:], [config.mu[3], config.B[4]])


def test_its_picture_is_drawn(table, place, tmp_path):
    rows = [{key: str(value) for key, value in row.items()} for row in table]
    PLAN.derived(rows, place).draw(tmp_path / "picture.png")
    assert (tmp_path / "picture.png").stat().st_size > 10_000
