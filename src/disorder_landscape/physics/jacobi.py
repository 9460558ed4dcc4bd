"""Complex symmetric matrices that are almost diagonal, by Jacobi's rotations.

The levels of a tunnel-coupled wire are shifted and mixed little by its leads, so nearly all
rotations are small and are left to the iteration that follows.
"""

from __future__ import annotations

import numba as nb
import numpy as np

from disorder_landscape.physics.parameters import FloatArray

MIXING = 0.1
"""Off-diagonal entries below this part of the levels' distance are not rotated away."""
SWEEPS = 12


@nb.njit(cache=True, fastmath={"contract", "nsz"}, error_model="numpy")
def _rotate_rows(
    re: FloatArray, im: FloatArray, p: int, q: int, c: complex, s: complex
) -> None:  # pragma: no cover
    """Replace rows p and q by c·p − s·q and s·p + c·q."""
    cr, ci, sr, si = c.real, c.imag, s.real, s.imag
    for j in range(re.shape[1]):
        pr, pi, qr, qi = re[p, j], im[p, j], re[q, j], im[q, j]
        re[p, j] = cr * pr - ci * pi - sr * qr + si * qi
        im[p, j] = cr * pi + ci * pr - sr * qi - si * qr
        re[q, j] = sr * pr - si * pi + cr * qr - ci * qi
        im[q, j] = sr * pi + si * pr + cr * qi + ci * qr


@nb.njit(cache=True, error_model="numpy")
def diagonalise_nearly(
    re: FloatArray, im: FloatArray, rows_re: FloatArray, rows_im: FloatArray
) -> bool:  # pragma: no cover
    """Rotate until every off-diagonal entry is below MIXING times the distance of its levels.

    The rows, shape (level, …), are rotated along. Returns whether that was reached.
    """
    n = re.shape[0]
    for _ in range(SWEEPS):
        rotated = False
        for p in range(n - 1):
            for q in range(p + 1, n):
                size = re[p, q] ** 2 + im[p, q] ** 2
                dr, di = re[q, q] - re[p, p], im[q, q] - im[p, p]
                if size <= MIXING**2 * (dr * dr + di * di) or size < 1e-40:
                    continue
                rotated = True
                off = complex(re[p, q], im[p, q])
                zeta = complex(dr, di) / (2 * off)
                root = np.sqrt(zeta * zeta + 1)
                t = 1 / (zeta + root if abs(zeta + root) > abs(zeta - root) else zeta - root)
                c = 1 / np.sqrt(t * t + 1)
                s = t * c
                hp = complex(re[p, p], im[p, p]) - t * off
                hq = complex(re[q, q], im[q, q]) + t * off
                _rotate_rows(re, im, p, q, c, s)
                _rotate_rows(rows_re, rows_im, p, q, c, s)
                re[p, p], im[p, p], re[q, q], im[q, q] = hp.real, hp.imag, hq.real, hq.imag
                re[p, q], im[p, q] = 0.0, 0.0
                re[q, p], im[q, p] = 0.0, 0.0
                for i in range(n):
                    if i not in (p, q):
                        re[i, p], im[i, p] = re[p, i], im[p, i]
                        re[i, q], im[i, q] = re[q, i], im[q, i]
        if not rotated:
            return True
    return False
