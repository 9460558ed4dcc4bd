"""Devices that are drawn from a prior, and what is said of an answer. Nothing is inverted."""

import zlib

import numpy as np
import pandas as pd
import pytest

from disorder_landscape.inference.optimum import optimum_at
from disorder_landscape.inference.outcome import Outcome
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.studies import devices, fresh_wires
from disorder_landscape.studies.devices import (
    Devices,
    Task,
    device_row,
    summary,
)
from disorder_landscape.studies.drawn_devices import drawn_device, measured_device
from disorder_landscape.studies.fresh_wires import Inverted

TASK = Task("some", 0.005, 1)
SEED = [fresh_wires.SEED, zlib.crc32(b"some"), 1]


def group(prior):
    return Devices(
        name="some", prior=prior, mu=(0.0, 0.4, 2), B_points=2, biases=3, noise=(0.005,), count=1
    )


@pytest.mark.parametrize("prior", ["device", "whole_landscape"])
def test_the_true_unknowns_explain_the_measurement(prior):
    """… which is made by another route, from the disorder before it is cut."""
    some = group(prior)
    device, truth = drawn_device(some.unknowns, some.grid, SEED)
    observation = measured_device(device, some.unknowns, some.grid, TASK.noise, SEED)
    off = some.unknowns.potential(truth) - device.wire.potential
    assert np.sqrt((off**2).mean()) < (1e-12 if prior == "device" else 2e-3)
    misfit = observation.simulate(truth[None])[0] - observation.data
    assert misfit.std() == pytest.approx(0.005, rel=0.3 if prior == "device" else 2.0)
    again, _ = drawn_device(some.unknowns, some.grid, SEED)
    np.testing.assert_array_equal(again.wire.potential, device.wire.potential)


def test_an_answer_is_compared_with_the_truth(monkeypatch):
    """One that is off by a shift of V, as if it were an offset of µ."""
    some = group("device")
    _, truth = drawn_device(some.unknowns, some.grid, SEED)
    mean = some.unknowns.names.index("mean")
    off = np.eye(truth.size)[mean]
    covariance = np.diag(np.where(off > 0, 4.0, 1e-6))

    def inverted(observation, network, seed):
        found = Outcome([optimum_at(observation, Gaussian(truth + off, covariance))])
        return Inverted(found, {"spread": observation.unknowns.site_std(covariance)})

    monkeypatch.setattr(devices, "inverted", inverted)
    row = device_row(TASK, some)
    shift = some.unknowns.potential(off)
    assert shift.std() < 1e-12
    assert row["site_error"] == pytest.approx(abs(shift[0]), rel=1e-4)
    assert row["shape_error"] == pytest.approx(0.0, abs=1e-9)
    assert row["spread"] == pytest.approx(2 * abs(shift[0]), rel=0.05)
    assert 0 < row["shape_spread"] < 1e-3
    assert row["more_probable"] == 0  # the truth is more probable than the answer
    z_scores = [float(z) for z in row["z_scores"].split()]
    assert z_scores[mean] == pytest.approx(-0.5)
    assert row["widths"].split()[mean] == "2"
    outcome = {"effective_sample_size": np.nan, "excess": 0.0, "verdict": "converged", "seconds": 9}
    said = summary(pd.DataFrame([row | outcome]), some.unknowns)
    assert said["widths"]["g"] == pytest.approx(1e-3)
    assert said["error"] == pytest.approx(1e3 * row["site_error"], abs=1e-3)
