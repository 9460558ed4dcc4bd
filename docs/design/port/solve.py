"""Solve the cases with one code: the compiled core, or the Numba code of commit 1e3d893.

The old code is no longer in the tree and needs a worktree, and Numba:

    git worktree add OLD 1e3d893
    NUMBA_NUM_THREADS=1 python docs/design/port/solve.py RESULTS/old --source OLD/src
    python docs/design/port/solve.py RESULTS/new
    python docs/design/port/report.py RESULTS/old RESULTS/new

There is a file of results for each kind; what is there already is not computed again. Besides the
result it holds by how much that moves when μ does by one rounding of 2t.
"""

from __future__ import annotations

import argparse
import itertools
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from cases import KINDS, Case, case

PER_MEV = np.array([1.0, 0.7236, 0.05])
"""What makes derivatives with respect to μ, B and α as those to V: V_Z/B, 1/2a."""


GROWTH_LIMIT = 1e7
"""Growth beyond which both codes pivot."""


def old_solvers(limit: float) -> dict[str, Callable[[Case], Any]]:
    """Return the Numba code's functions of a case."""
    from disorder_landscape.physics import above_gap, fast_solver, finite_temperature, transport
    from disorder_landscape.physics import tilted_average, tilted_field

    tilted_field.GROWTH_LIMIT = limit
    return {
        "bare": lambda c: fast_solver.bare_conductance([c.wire], c.mu, c.B, c.omega, limit),
        "lossy": lambda c: above_gap.bare_conductance([c.wire], c.mu, c.B, c.omega, limit),
        "det": lambda c: fast_solver.reflection_determinant([c.wire], c.mu, c.B, limit),
        "warm": lambda c: finite_temperature.thermal_conductance(
            [c.wire], c.mu, c.B, c.omega, c.temperature
        ),
        "tilted": lambda c: tilted_field.bare_conductance(
            [c.wire], c.mu, c.B, c.omega, c.theta, limit
        ),
        "det, tilted": lambda c: tilted_field.reflection_determinant(
            [c.wire], c.mu, c.B, c.theta
        ),
        "warm, tilted": lambda c: tilted_average.thermal_conductance(
            [c.wire], c.mu, c.B, c.omega, c.temperature, c.theta
        ),
        "average": lambda c: transport.exact_average(
            [c.wire], c.mu, c.B, c.omega, c.temperature
        ),
    }


def new_solvers(limit: float) -> dict[str, Callable[[Case], Any]]:
    """Return the compiled core's."""
    from disorder_landscape.solver import compiled, routes
    from disorder_landscape.solver.compiled import core, handed_over

    core.set_threads(1)
    return {
        "bare": lambda c: compiled.bare_conductance([c.wire], c.mu, c.B, c.omega, 0.0, limit),
        "lossy": lambda c: core.internals.complex_conductance(
            *handed_over([c.wire]), c.mu, c.B, c.omega, 0.0, limit
        ),
        "det": lambda c: compiled.reflection_determinant([c.wire], c.mu, c.B, 0.0, limit),
        "warm": lambda c: compiled.thermal_conductance([c.wire], c.mu, c.B, c.omega, c.temperature),
        "tilted": lambda c: compiled.bare_conductance(
            [c.wire], c.mu, c.B, c.omega, c.theta, limit
        ),
        "det, tilted": lambda c: compiled.reflection_determinant(
            [c.wire], c.mu, c.B, c.theta, limit
        ),
        "warm, tilted": lambda c: routes.closed_form(
            [c.wire], c.mu, c.B, c.omega, c.temperature, c.theta
        ),
        "average": lambda c: routes.thermal_average(
            [c.wire], c.mu, c.B, c.omega, c.temperature
        ),
    }


def solve(
    kind: str, c: Case, solvers: dict[str, Callable[[Case], Any]], limit: float
) -> tuple[Any, Any]:
    """Return the values of all points of a case, shape (point, value), and their estimated error.

    Derivatives come as (conductance, site … μ, B, α), those that are not to V as if to V.
    """
    from disorder_landscape import conductance_gradient
    error = np.zeros(c.mu.size)
    if "mK" in kind:
        if "quadrature" in kind:
            G, error, _ = solvers["average"](c)
        elif "tilted" in kind:
            G, error, _ = solvers["warm, tilted"](c)
        else:
            G, error, _ = solvers["warm"](c)
        return G.reshape(c.mu.size, -1), error.ravel()
    if kind == "gradient":
        data = conductance_gradient(c.wire, c.mu, c.B, c.omega, limit)
        names = ("G_LL", "G_RR", "G_LR", "G_RL")
        V = np.array([data[f"d{name}_dV"].values for name in names])
        others = np.array(
            [[data[f"d{n}_d{p}"].values for p in ("mu", "B", "alpha")] for n in names]
        )
        others = np.moveaxis(others, 1, -1) / PER_MEV
        points = c.mu.size * c.omega.size
        every = np.concatenate([V, others], axis=-1).reshape(4, points, -1).swapaxes(0, 1)
        return every.reshape(points, -1), np.zeros(points)
    if "det" in kind:
        T = solvers["det" if c.theta == 0 else "det, tilted"](c)
        return T[0, :, :, 0].T, error
    if kind == "tilted":
        G = solvers["tilted"](c)
    else:
        G = solvers["bare" if kind == "T = 0" else "lossy"](c)
    return G.reshape(-1, 8), np.zeros(c.mu.size * c.omega.size)


def attempt(
    kind: str, c: Case, solvers: dict[str, Callable[[Case], Any]], limit: float
) -> tuple[Any, Any]:
    """Return what `solve` does, or no numbers where the code raises an error."""
    try:
        return solve(kind, c, solvers, limit)
    except (ArithmeticError, SystemError, np.linalg.LinAlgError):
        points = c.mu.size * (1 if "det" in kind or "mK" in kind else c.omega.size)
        width = 2 if "det" in kind else 4 * (c.wire.sites + 3) if kind == "gradient" else 8
        width = 4 * c.omega.size if "mK" in kind else width
        return np.full((points, width), np.nan), np.full(points, np.nan)


def run(folder: Path, source: Path | None, kinds: list[str], limit: float, only: Any) -> None:
    """Solve all cases of the kinds with one code, or only some cases."""
    if source is not None:  # the editable install would find the new code first
        sys.meta_path[:] = [f for f in sys.meta_path if "editable" not in type(f).__module__]
        sys.path.insert(0, str(source.resolve()))
    import disorder_landscape

    if source is not None:
        assert Path(disorder_landscape.__file__).is_relative_to(source.resolve())
        from disorder_landscape.physics import compilation

        compilation.main()
    solvers = (new_solvers if source is None else old_solvers)(limit)
    folder.mkdir(parents=True, exist_ok=True)
    for kind in kinds:
        path = folder / f"{kind}.npz"
        if path.exists():
            continue
        start, count, parts, cases = time.perf_counter(), 0, [], []
        for index in itertools.count() if only is None else only[kind]:
            c = case(kind, index)
            values, error = attempt(kind, c, solvers, limit)
            rounding = np.finfo(np.float64).eps * 2 * c.wire.hopping
            moved, _ = attempt(kind, c._replace(mu=c.mu + rounding), solvers, limit)
            parts.append((values.ravel(), error, abs(moved - values).max(axis=1)))
            cases.append((index, *values.shape))
            count += len(error)
            if only is None and count >= KINDS[kind]:
                break
        values, error, unknown = (np.concatenate(x) for x in zip(*parts, strict=True))
        np.savez(path, values=values, error=error, unknown=unknown, cases=np.array(cases))
        print(f"{kind}: {count} points, {time.perf_counter() - start:.0f} s", flush=True)


def main() -> None:
    """Solve."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--source", type=Path, help="src of the old code; without it, the new one")
    parser.add_argument("--kinds", nargs="*", choices=list(KINDS))
    parser.add_argument(
        "--pivot", type=Path, metavar="FILE", help="pivot, in the file's cases only"
    )
    options = parser.parse_args()
    only = json.loads(options.pivot.read_text("utf-8")) if options.pivot else None
    kinds = options.kinds or list(KINDS if only is None else only)
    run(options.folder, options.source, kinds, 0.0 if options.pivot else GROWTH_LIMIT, only)


if __name__ == "__main__":
    main()
