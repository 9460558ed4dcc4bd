"""Where V of every site is unknown: a grid of µ, B and bias, and data that are linear."""

from dataclasses import replace

import numpy as np

import disorder_landscape as dl
from disorder_landscape.inference.problem.measurement import Measurement
from disorder_landscape.inference.problem.noise import noise_of_channels
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.problem.prior import Prior
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.model.disorder import smooth_noise
from disorder_landscape.solver.quadrature import thermal_quadrature
from linear_data import DATA, Linear

SITES, AMPLITUDE, NOISE = 30, 0.8, 0.002
MU, B, BIAS = np.linspace(0, 4.2, 12), np.linspace(0, 0.8, 3), np.linspace(-0.08, 0.08, 5)
NOTHING = Measurement(np.zeros((12, 3, 5, 4)), MU, B, BIAS, 0.0, (15.0, 15.0), 0.05)
UNKNOWNS = Unknowns(
    Prior(components=None, sites=SITES, amplitude=AMPLITUDE).for_measurement(NOTHING)
)


class Whole(Linear):
    """Linear data of a whole landscape, all of them in each part."""

    measurement = NOTHING

    def at(self, mu, B, bias):
        return replace(self)

    def on_few_points(self, *counts):
        return replace(self)

    def on_random_points(self, highest, counts, rng):
        return replace(self)


def measured_landscape(mu, B):
    """Return V of a wire, and what is measured of it, by quadrature: another route."""
    rng = np.random.default_rng(1)
    V = smooth_noise(rng, SITES, 3, "sum", AMPLITUDE)
    V -= V.mean()
    exact = thermal_quadrature([dl.Nanowire(potential=V)], mu, B, BIAS, 0.05).conductance[0]
    G = exact + NOISE * rng.normal(size=exact.shape)
    measurement = replace(NOTHING, G=G, mu=mu, B=B)
    return V, Observation(measurement, UNKNOWNS, noise_of_channels(NOISE))


def linear_landscape():
    """Return linear data of a draw of the prior, without noise."""
    rng = np.random.default_rng(0)
    slope = rng.normal(size=(len(UNKNOWNS.names), DATA))
    truth = rng.normal(size=len(UNKNOWNS.names))
    return Whole(truth @ slope, slope, unknowns=UNKNOWNS)
