"""The isolated wire in a tilted field as a small matrix, from its ends' Green's function.

Below the gap F(z) = Σ_n u_n u_n†/(z − E_n): rational but for the parent superconductor's continuum,
which far levels stand for. X(z) = (z − H)⁻¹e, the wire's answer to a source on the 8 entries of
its ends, spans a space in which Rayleigh–Ritz gives H. The matrix elements follow from F alone, at
nodes z_k above the axis:

    X_k†X_l = −(F_l − F_k†)/(z_l − z_k*),   X_k†H X_l = z_l X_k†X_l − F_k†,   e†X_l = F_l.

(core/poles/levels.hpp does the same with slopes, at real energies, in a real frame that θ ≠ 0
takes away.)
Particle–hole symmetry gives the nodes −z_k* for nothing: with sources that are their own
antiparticles F(−z*) = −F(z)*, and X_k − X(−z_k*) and i(X_k + X(−z_k*)) are their own antiparticles
too, so that their overlaps are real and those with H imaginary: F(z) = u(z − iA)⁻¹uᵀ, all real.
"""

from __future__ import annotations

import numpy as np

from disorder_landscape.model.hamiltonian import PARTICLE_HOLE, ComplexArray
from disorder_landscape.model.parameters import FloatArray

DROP = 1e-13
"""Directions of which less than this (squared, relative) is new are left out of the model."""


def _majorana_basis() -> ComplexArray:
    """Return the 8 combinations of the ends' entries that are their own antiparticles: CW* = W."""
    value, vector = np.linalg.eigh(np.kron(np.eye(2), PARTICLE_HOLE.real))
    return np.asarray(vector * np.where(value > 0, 1, 1j), dtype=np.complex128)


BASIS = _majorana_basis()
"""In which antiparticles are complex conjugates, unitary."""


def isolated_wire(z: ComplexArray, F: ComplexArray) -> tuple[FloatArray, FloatArray]:
    """Return A and u, by which the ends' Green's function is BASIS u(z − iA)⁻¹uᵀ BASIS†.

    Parameters
    ----------
    z : array, shape (node,)
        Energies with positive real and imaginary part in meV.
    F : array, shape (node, 8, 8)
        The ends' Green's function there in 1/meV, of `compiled.isolated_ends`.

    Returns
    -------
    A : array, shape (level, level)
        Antisymmetric, in meV.
    u : array, shape (8, level)
    """
    F = BASIS.conj().T @ F @ BASIS
    F = np.concatenate([F, -F.conj()])
    nodes = np.concatenate([z, -z.conj()])
    bra = F.conj().swapaxes(1, 2)[:, None]
    overlap = -(F - bra) / (nodes - nodes.conj()[:, None])[..., None, None]  # (k, l, 8, 8)
    energy = nodes[:, None, None] * overlap - bra
    real, imaginary = _antiparticles(overlap).real, _antiparticles(energy).imag
    seen = _antiparticles(F[None]).real
    scale = 1 / np.sqrt(np.diag(real))
    value, vector = np.linalg.eigh(scale[:, None] * real * scale)
    kept = value > DROP * value[-1]
    chosen = scale[:, None] * vector[:, kept] / np.sqrt(value[kept])
    A = chosen.T @ imaginary @ chosen
    return (A - A.T) / 2, seen @ chosen


def _antiparticles(blocks: ComplexArray) -> ComplexArray:
    """Return a matrix of (k, l, 8, 8) blocks between the real combinations of X(z), X(−z*).

    With one row of blocks, those between e and the combinations, in the first 8 rows.
    """
    half = blocks.shape[1] // 2
    left, right = blocks[:, :half], blocks[:, half:]
    blocks = np.concatenate([left - right, 1j * (left + right)], axis=1) / np.sqrt(2)
    if len(blocks) > 1:
        up, down = blocks[:half], blocks[half:]
        blocks = np.concatenate([up - down, -1j * (up + down)]) / np.sqrt(2)
    rows, columns = blocks.shape[:2]
    return np.asarray(blocks.swapaxes(1, 2).reshape(8 * rows, 8 * columns))
