"""What a wire without leads looks like inside: levels, wave functions, Majorana components.

The self-energy of the parent superconductor depends on the energy, so a level E is a root of
det[E − H − Σ(E)]. The compiled core brackets it (core/spectrum.hpp); inverse iteration gives its
wave function. Of a pair ±E, with ψ and Cψ*, the combinations γ = Cγ* are Majorana components: γ_A
and γ_B are the two that lie furthest apart along the wire (at θ = 0 the parts of either chirality,
C = ±1). Both are as well known as the plane of ψ and Cψ*, though E be lost in rounding.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from scipy.linalg import schur, solve_banded

from disorder_landscape.arguments import number_in, require, shown, whole_number_in
from disorder_landscape.model.hamiltonian import (
    BANDS,
    FULL_TURN,
    PARTICLE_HOLE,
    TAU_X,
    ComplexArray,
    banded,
    hopping,
    onsite,
)
from disorder_landscape.model.parameters import FloatArray, Nanowire
from disorder_landscape.model.quantities import with_units
from disorder_landscape.model.ranges import B_RANGE, MU_RANGE
from disorder_landscape.solver import compiled

NAMBU = ("u_up", "u_down", "-v_down", "v_up")
"""Components of the spinor, in the order of Eq. S1's basis."""
EQUAL = 1e-11
"""Levels nearer to each other than this, in meV, are one, of several wave functions."""
NEAR_ZERO = 1e-9
"""A level below this, in meV, is taken together with its mirror image."""
ITERATIONS = 4
"""Inverse iterations; at a level that is known to 1e-12 meV the first one leaves 1e-9 of others."""
ROUNDING = float(np.finfo(float).eps)


def modes(wire: Nanowire, mu: float, B: float, count: int = 1, theta: float = 0.0) -> xr.Dataset:
    """Return the lowest levels of a wire without leads, and what their modes look like.

    Parameters
    ----------
    wire : Nanowire
        Without dissipation and leads: levels need not be where the leads broaden and shift them.
    mu, B : float
        Chemical potential in meV and field in T.
    count : int
        How many levels E ≥ 0; of each there is one at −E.
    theta : float
        Angle of the field relative to the wire in radians.

    Returns
    -------
    xarray.Dataset
        - level (mode): E in meV.
        - wave_function (mode, site, nambu): ψ in the basis of Eq. S1, normalised to 1 in the wire.
          As Σ depends on the energy, those of different levels are not orthogonal.
        - wire_weight (mode): 1/⟨ψ|1 − ∂Σ/∂ω|ψ⟩, the share that is not in the parent.
        - majorana_A, majorana_B (site, nambu): γ_A and γ_B of the lowest pair, each its own
          particle–hole image and normalised to 1, ψ = (γ_A + iγ_B)/√2 up to a phase; A is the one
          further left. Every level has them: it is their distance that makes zero modes of them.
        - separation: distance of their centres of weight, as a share of the wire.
        - overlap: of the moduli of both, summed over the sites; 0 if they are apart, 1 if equal.

    Raises
    ------
    ArgumentError
        If the wire is not one or has dissipation, a number is out of range, or there are fewer
        levels below the gap.
    """
    require(isinstance(wire, Nanowire), "wire", "be a Nanowire", f"it is {shown(wire)}")
    require(wire.lossless, "wire", "have no dissipation for its levels", "it has")
    mu, B = number_in("mu", mu, *MU_RANGE), number_in("B", B, *B_RANGE)
    wire = wire.in_field(B)
    theta = number_in("theta", theta, -FULL_TURN, FULL_TURN, "radians")
    count = whole_number_in("count", count, 1, 2 * wire.sites)
    E = compiled.levels([wire], np.array([mu]), np.array([B]), count, theta)[0, 0, 0]
    there = int(np.isfinite(E).sum())
    must = "be at most the number of levels below the gap"
    require(there == count, "count", must, f"there are {there}, not {count}")
    waves = np.concatenate(
        [_wave_functions(wire, mu, B, theta, same) for same in _groups(E)], axis=0
    )
    A, other = _majorana_components(waves[0])
    moduli = np.linalg.norm(A, axis=1), np.linalg.norm(other, axis=1)
    data = {
        "level": ("mode", E),
        "wave_function": (("mode", "site", "nambu"), waves),
        "wire_weight": ("mode", [_weight(wire, e, wave) for e, wave in zip(E, waves, strict=True)]),
        "majorana_A": (("site", "nambu"), A),
        "majorana_B": (("site", "nambu"), other),
        "separation": ((), separation(A, other)),
        "overlap": ((), float(moduli[0] @ moduli[1])),
    }
    coordinates = {
        "mode": np.arange(1, count + 1),
        "site": np.arange(wire.sites),
        "nambu": list(NAMBU),
    }
    attrs = {"mu": mu, "B": B, "theta": theta}
    return with_units(xr.Dataset(data, coords=coordinates, attrs=attrs))


def _groups(E: FloatArray) -> list[FloatArray]:
    """Cut the levels where neighbours are not equal (Kramers pairs at B = 0 are)."""
    return np.split(E, np.flatnonzero(np.diff(E) > EQUAL) + 1)


def _wave_functions(
    wire: Nanowire, mu: float, B: float, theta: float, E: FloatArray
) -> ComplexArray:
    """Return orthonormal wave functions of so many equal levels, shape (level, site, 4)."""
    level, near_zero = float(E.mean()), bool(E[0] < NEAR_ZERO)
    blocks = onsite(wire, wire.potential_with_barriers, mu, B, level, theta)
    matrix = banded(level * np.eye(4) - blocks, -hopping(wire))
    matrix[BANDS] += ROUNDING * wire.hopping  # no pivot vanishes at the level itself
    width = E.size * (2 if near_zero else 1)  # near zero both ±E are found
    rng = np.random.default_rng(0)
    X = rng.normal(size=(2, 4 * wire.sites, width)).T.copy().view(complex)[..., 0].T
    for _ in range(ITERATIONS):
        X = np.linalg.qr(solve_banded((BANDS, BANDS), matrix, X))[0]
    waves = X.T.reshape(width, wire.sites, 4)
    if near_zero:
        waves = _of_positive_energy(waves, blocks, hopping(wire))
    return np.asarray(waves)


def _of_positive_energy(
    waves: ComplexArray, blocks: ComplexArray, coupling: ComplexArray
) -> ComplexArray:
    """Return the half with E ≥ 0 of what spans a space that holds ψ and Cψ* of each mode.

    Between vectors γ = Cγ* the Hamiltonian is i times a real antisymmetric matrix, whose real Schur
    form pairs them, whatever the rounding of E.
    """
    images = particle_hole_images(waves)
    selves = np.concatenate([waves + images, 1j * (waves - images)]).reshape(2 * len(waves), -1)
    of_gram, combinations = np.linalg.eigh((selves.conj() @ selves.T).real)
    best = slice(len(waves), None)  # as many as there are; the others are zero
    gammas = (combinations[:, best] / np.sqrt(of_gram[best])).T @ selves
    shaped = gammas.reshape(waves.shape)
    on_them = np.einsum("sij,wsj->wsi", blocks, shaped)
    on_them[:, :-1] += shaped[:, 1:] @ coupling.T
    on_them[:, 1:] += shaped[:, :-1] @ coupling.conj()
    A = (gammas.conj() @ on_them.reshape(gammas.shape).T).imag
    form, Q = schur((A - A.T) / 2, output="real")
    first, second = (np.tensordot(Q[:, k::2].T, shaped, 1) for k in (0, 1))
    signs = np.where(np.diag(form, 1)[::2] > 0, -1, 1)[:, None, None]
    return np.asarray((first + 1j * signs * second) / np.sqrt(2))


def particle_hole_images(waves: ComplexArray) -> ComplexArray:
    """Return Cψ* of wave functions, shape (..., 4)."""
    return np.asarray(waves.conj() @ PARTICLE_HOLE.T)


def _majorana_components(wave: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Return γ_A and γ_B, shape (site, 4), of a mode: ψ = (γ_A + iγ_B)/√2 up to a phase of ψ."""
    image = particle_hole_images(wave)
    pair = np.stack([wave + image, (wave - image) / 1j]) / np.sqrt(2)
    position = np.arange(len(wave)) - (len(wave) - 1) / 2
    places = np.einsum("asi,s,bsi->ab", pair.conj(), position, pair).real
    _, turn = np.linalg.eigh(places)
    A, B = np.tensordot(turn.T, pair, 1)
    return A, B * np.linalg.det(turn)


def lowest_components(
    wire: Nanowire, mu: float, B: float, theta: float, levels: FloatArray
) -> tuple[ComplexArray, ComplexArray]:
    """Return γ_A and γ_B, shape (site, 4), of the lowest of some levels, in a wire's own field."""
    return _majorana_components(_wave_functions(wire, mu, B, theta, _groups(levels)[0])[0])


def separation(A: ComplexArray, B: ComplexArray) -> float:
    """Return the distance of the centres of two components, shape (site, 4), over the length."""
    centres = [(abs(one) ** 2).sum(axis=1) @ np.arange(len(one)) for one in (A, B)]
    return float((centres[1] - centres[0]) / (len(A) - 1))


def _weight(wire: Nanowire, E: float, wave: ComplexArray) -> float:
    """Return 1/⟨ψ|1 − ∂Σ/∂ω|ψ⟩."""
    slope = wire.gamma * wire.delta0 / (wire.delta0**2 - E**2) ** 1.5
    in_parent = slope * (wire.delta0 * np.eye(4) + E * TAU_X)
    return float(1 / (1 + np.einsum("si,ij,sj->", wave.conj(), in_parent, wave).real))
