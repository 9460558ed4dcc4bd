"""Finite temperature by adaptive quadrature, at any T > 0: hot wires, and the check of the rest.

G(V) = ∫ dω G₀(ω) (1/4kT) sech²((ω − V)/2kT), with nothing assumed about G₀ but its bound.

In u, ω = Δ₀(1 + u|u|), G₀ is smooth on both sides of the gap edge u = 0, where it has square roots
of |Δ₀ − ω|. Panels of u are halved until two nested rules, of 15 and 7 nodes, agree on each.

Below the gap G₀ has resonances down to 1e-6 µeV. One that falls between the nodes betrays itself by
its tails: at the distance d its half-width g leaves G_max (g/d)², and what would be missed is its
area, π G_max g. With d a twentieth of the panel (the nodes are no further apart), m the thermal
weight of the panel and δ the difference of the rules, to which the tails add some hundredths of
themselves, that is of the order of √(G_max m δ). The largest such value is part of the error
estimate, and most of it. Over 500 random (wire, μ, B) from 20 to 300 mK the estimate was at most
7.4e-6 e²/h, the true error at most 3.3e-7, and the one 1.4 (as a rule 90) times the other or more.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from disorder_landscape.arguments import require
from disorder_landscape.model.parameters import BOLTZMANN, FloatArray, Nanowire
from disorder_landscape.solver import compiled

TOLERANCE = 5e-8
"""Error in e²/h that is spread over the window in proportion to energy."""
FLOOR = 1e-3
"""Share of the tolerance that any panel may use, however narrow."""
REACH = 16.0
"""The window reaches this many kT beyond each |V|."""
PANEL = 0.1
"""Width of the first panels below the gap, in kT."""
WIDER_ABOVE = 20.0
"""How much wider they are above the gap, where the parent superconductor broadens every level."""
NEAREST = 1e-7
"""Smallest |u| that is distinguished from the gap edge itself, where Σ(ω) is infinite."""
LARGEST_G = 4.0
"""Bound of |G₀| in e²/h: two for each of the two channels of a lead."""

# Gauss–Kronrod rule of 7 and 15 nodes (QUADPACK): nodes and weights of one half, from the outermost
_NODES = [0.991455371120812639, 0.949107912342758525, 0.864864423359769073, 0.741531185599394440]
_NODES += [0.586087235467691130, 0.405845151377397167, 0.207784955007898468, 0.0]
_KRONROD = [0.022935322010529225, 0.063092092629978553, 0.104790010322250184, 0.140653259715525919]
_KRONROD += [0.169004726639267903, 0.190350578064785410, 0.204432940075298892, 0.209482141084727828]
_GAUSS = [0.0, 0.129484966168869693, 0.0, 0.279705391489276668]
_GAUSS += [0.0, 0.381830050505118945, 0.0, 0.417959183673469388]
NODES = np.array([-x for x in _NODES] + _NODES[-2::-1])
WEIGHTS = np.array([rule + rule[-2::-1] for rule in (_KRONROD, _GAUSS)])


class ThermalConductance(NamedTuple):
    """What `thermal_quadrature` returns."""

    conductance: FloatArray
    """Shape (wire, mu, B, bias, 4): G_LL, G_RR, G_LR, G_RL in e²/h."""
    error: FloatArray
    """Estimated error of the largest of them, shape (wire, mu, B), in e²/h; infinite where one is
    no number."""
    energies: NDArray[np.int64]
    """Energies solved, shape (wire, mu, B)."""


def thermal_quadrature(
    wires: Sequence[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    bias: FloatArray,
    temperature: float,
    tolerance: float = TOLERANCE,
    panel: float = PANEL,
    reach: float = REACH,
    theta: float = 0.0,
) -> ThermalConductance:
    """Return the conductance matrix at a finite temperature.

    Parameters
    ----------
    wires : sequence of Nanowire
        Of equal length.
    mu, B, bias : array, shape (mu,), (B,), (bias,)
        In meV, T and meV.
    temperature : float
        T > 0 in K.
    tolerance, panel, reach : float
        As TOLERANCE, PANEL and REACH.
    theta : float
        Angle of the field in radians.

    Raises
    ------
    ArgumentError
        If the temperature is not positive.
    """
    require(temperature > 0, "temperature", "be positive", f"it is {temperature!r}")
    kT = BOLTZMANN * temperature
    shape = len(wires), mu.size, B.size
    G, error = np.empty((*shape, bias.size, 4)), np.empty(shape)
    energies = np.empty(shape, dtype=np.int64)
    for index in np.ndindex(shape):
        w, m, f = index
        bare = _BareConductance(wires[w], mu[m : m + 1], B[f : f + 1], theta)
        low, high = _first_panels(wires[w], bias, kT, panel, reach)
        G[index], rules, missed = _integral(bare, low, high, bias, kT, tolerance)
        finite = np.isfinite(G[index]).all()
        error[index] = rules + missed + LARGEST_G * np.exp(-reach) if finite else np.inf
        energies[index] = bare.energies
    return ThermalConductance(G, error, energies)


class _BareConductance:
    """G₀(±ω) of one wire at one μ, B and θ, and how many energies it has been asked for."""

    def __init__(self, wire: Nanowire, mu: FloatArray, B: FloatArray, theta: float) -> None:
        self.wire, self.mu, self.B, self.theta = wire, mu, B, theta
        self.energies = 0

    def __call__(self, omega: FloatArray) -> FloatArray:
        """Return G₀(±ω), shape (omega, 2, 4), for ω ≥ 0."""
        self.energies += omega.size
        arguments = [self.wire], self.mu, self.B, omega, self.theta
        return np.asarray(compiled.bare_conductance(*arguments)[0, 0, 0])


def _first_panels(
    wire: Nanowire, bias: FloatArray, kT: float, panel: float, reach: float
) -> tuple[FloatArray, FloatArray]:
    """Return both ends in u of panels that cover the energies within reach of |V|, or of −|V|."""
    centres = np.unique(abs(bias))
    gaps = np.flatnonzero(np.diff(centres) > 2 * reach * kT)
    starts = np.maximum(centres[np.append(0, gaps + 1)] - reach * kT, 0.0)
    ends = centres[np.append(gaps, -1)] + reach * kT
    width = panel * kT
    # without coupling to the parent, levels above the gap are as narrow as below
    above = np.clip(wire.gamma / 4, width, WIDER_ABOVE * width)
    low, high = [], []
    for start, end in zip(starts, ends, strict=True):
        middle = np.clip(wire.delta0, start, end)
        for a, b, step in ((start, middle, width), (middle, end, above)):
            edges = np.linspace(a, b, int(np.ceil((b - a) / step)) + 1)
            edges = edges / wire.delta0 - 1
            edges = np.sign(edges) * np.sqrt(abs(edges))
            low.append(edges[:-1])
            high.append(edges[1:])
    return np.concatenate(low), np.concatenate(high)


def _integral(
    bare: _BareConductance,
    low: FloatArray,
    high: FloatArray,
    bias: FloatArray,
    kT: float,
    tolerance: float,
) -> tuple[FloatArray, float, float]:
    """Return G(V), shape (bias, 4), the two rules' total difference, and what may be missed."""
    delta0 = bare.wire.delta0
    window = np.sum(_energy(high, delta0) - _energy(low, delta0))
    G, error, missed = np.zeros((bias.size, 4)), np.zeros((bias.size, 4)), 0.0
    while low.size:
        middle, half = (low + high) / 2, (high - low) / 2
        u = middle[:, None] + half[:, None] * NODES
        omega = _energy(u, delta0)
        weights = half[:, None] * 2 * delta0 * abs(u) * WEIGHTS[:, None]  # (rule, panel, node)
        kernel = np.stack([_kernel(s * omega[..., None] - bias, kT) for s in (1, -1)], axis=2)
        G0 = bare(omega.ravel()).reshape(*omega.shape, 2, 4)
        fine, coarse = np.einsum("rpn,pnsv,pnsg->rpvg", weights, kernel, G0, optimize=True)
        difference = abs(fine - coarse)
        share = (_energy(high, delta0) - _energy(low, delta0)) / window
        good = ~(difference.max(axis=(1, 2)) > tolerance * np.maximum(share, FLOOR))  # NaN ends it
        G += fine[good].sum(axis=0)
        error += difference[good].sum(axis=0)
        mass = np.einsum("pn,pnsv->pv", weights[0], kernel)[good]
        hidden = np.sqrt(LARGEST_G * mass * difference[good].max(axis=2))
        missed = max(missed, hidden.max(initial=0.0))
        low, middle, high = low[~good], middle[~good], high[~good]
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
    return G, float(error.max()), missed


def _energy(u: FloatArray, delta0: float) -> FloatArray:
    u = np.copysign(np.maximum(abs(u), NEAREST), u)
    return np.asarray(delta0 * (1 + u * abs(u)))


def _kernel(x: FloatArray, kT: float) -> FloatArray:
    """Return (1/4kT) sech²(x/2kT), without overflow."""
    decay = np.exp(-abs(x) / kT)
    return np.asarray(decay / (1 + decay) ** 2 / kT)
