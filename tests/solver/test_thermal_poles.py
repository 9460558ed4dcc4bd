"""Averages of poles in closed form."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from scipy.special import polygamma

from disorder_landscape.model.parameters import BOLTZMANN
from disorder_landscape.solver.compiled import core

KT = BOLTZMANN * 0.05


def trigamma(z):
    """Return ψ₁ of complex numbers of real part ½ or more."""
    return core.trigamma(np.array([z], dtype=complex))[0]


def test_trigamma_on_the_real_axis():
    x = np.concatenate([np.geomspace(0.5, 1e3, 60), [7.999, 8.0]])
    assert_allclose(trigamma(x).real, polygamma(1, x), rtol=1e-12)
    assert_allclose(trigamma(x).imag, 0, atol=1e-15)


def test_trigamma_by_recurrence_and_reflection():
    rng = np.random.default_rng(0)
    z = rng.uniform(0.5, 3, 50) + 1j * rng.uniform(-12, 12, 50)
    assert_allclose(trigamma(z + 1) + z**-2, trigamma(z), rtol=1e-11)
    assert_allclose(trigamma(z.conj()), trigamma(z).conj(), rtol=1e-14)
    z = 0.5 + 1j * rng.uniform(-6, 6, 50)  # where 1 − z has the real part ½ as well
    assert_allclose(trigamma(1 - z) + trigamma(z), (np.pi / np.sin(np.pi * z)) ** 2, atol=1e-11)


def one_pole(z, residues):
    """Return poles and residues, shapes (pole,) and (pole, 2, 4), all but one of them zero."""
    poles, r = np.full(8, -1j), np.zeros((8, 2, 4), dtype=complex)
    poles[3], r[3] = z, residues.reshape(2, 4)
    return poles, r


@pytest.mark.parametrize("z", [0.02 - 0.004j, -0.01 - 2e-4j, 0.0 - 0.03j, 0.3 - 1e-3j])
@pytest.mark.parametrize("V", [0.0, 0.025])
def test_the_thermal_average_of_a_pole(z, V):
    rng = np.random.default_rng(1)
    r = rng.normal(size=8) + 1j * rng.normal(size=8)
    found = np.ones((2, 4))
    core.internals.average_poles(*one_pole(z, r), np.array([V, -V]), KT, found)

    def at(omega):
        """Return the conductances at ω: of the pole, and of its mirror image."""
        return 2 * (r[:4] / (omega - z) - r[4:].conj() / (omega + z.conjugate())).real

    for bias, row in zip((V, -V), found - 1, strict=True):
        ends = bias - 40 * KT, bias + 40 * KT
        near = z.imag * np.array([-10, -1, 0, 1, 10])
        points = [*(z.real + near), *(-z.real + near), bias]
        for c in range(4):

            def integrand(x, c=c, bias=bias):
                return at(x)[c] * np.cosh((x - bias) / (2 * KT)) ** -2 / (4 * KT)

            expected = quad(integrand, *ends, points=points, limit=500, epsabs=1e-10)[0]
            assert_allclose(row[c], expected, rtol=1e-8)


def test_the_sum_of_poles():
    rng = np.random.default_rng(2)
    z, r = 0.03 - 0.002j, rng.normal(size=8) + 1j * rng.normal(size=8)
    omega = rng.uniform(-0.1, 0.1, core.internals.COLUMNS)
    found = core.internals.sum_poles(*one_pole(z, r), omega)
    mirrored = -r[4:, None].conj() / (omega + z.conjugate())
    assert_allclose(found, 2 * (r[:4, None] / (omega - z) + mirrored).real, rtol=1e-12)
