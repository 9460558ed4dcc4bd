"""Compare what solve.py has left: one row of the table in docs/design/port.md for each kind.

Below each row are the worst cases with their true errors. At T = 0 the truth comes from numbers of
600 bits (exact.py, which needs python-flint), above it from adaptive quadrature.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import exact
import numpy as np
from cases import KINDS, Case, case
from solve import PER_MEV

from disorder_landscape.solver.quadrature import thermal_quadrature

CLOSE = 1e-11
"""Difference that is asked for where the algorithm is the same."""
SMALLEST = 1e-6
"""Derivatives in e²/h per meV are compared relative to the largest of their point, or to this."""


class Compared(NamedTuple):
    """One kind of results of both codes; arrays are by points but for the values."""

    kind: str
    cases: Any  # (case,), their indices
    first: Any  # (case + 1,), the first point of each
    starts: Any  # (point,), the first value of each
    values: tuple[Any, Any]  # old, new
    error: tuple[Any, Any]
    unknown: Any  # how far one rounding moves the old or the new result
    difference: Any

    def where(self, p: Any) -> tuple[int, int]:
        """Return the index of the case of a point, and which of its points it is."""
        row = int(np.searchsorted(self.first, p, side="right")) - 1
        return int(self.cases[row]), int(p - self.first[row])

    def point(self, p: Any) -> tuple[Case, int, list[Any]]:
        """Return the case of a point, which of its points it is, and old and new values."""
        index, i = self.where(p)
        low, high = np.append(self.starts, self.values[0].size)[p : p + 2]
        return case(self.kind, index), i, [v[low:high] for v in self.values]


def compared(kind: str, folders: tuple[Path, Path]) -> Compared:
    """Read one kind; derivatives are compared in units of the largest of their point."""
    old, new = (dict(np.load(folder / f"{kind}.npz")) for folder in folders)
    assert (old["cases"] == new["cases"]).all()
    cases, points, width = old["cases"].T
    starts = np.append(0, np.cumsum(np.repeat(width, points)))[:-1]
    difference = np.maximum.reduceat(abs(old["values"] - new["values"]), starts)  # NaN stays
    unknown = np.fmax(old["unknown"], new["unknown"])
    if kind == "gradient":
        largest = np.maximum(np.maximum.reduceat(abs(old["values"]), starts), SMALLEST)
        difference, unknown = difference / largest, unknown / largest
    values, error = (old["values"], new["values"]), (old["error"], new["error"])
    first = np.append(0, np.cumsum(points))
    return Compared(kind, cases, first, starts, values, error, unknown, difference)


def truth(data: Compared, p: Any) -> tuple[float, float, float]:
    """Return how far old and new are from the exact result, and how far one rounding moves that."""
    c, i, both = data.point(p)
    if "mK" in data.kind:
        mu = c.mu[i : i + 1]
        finer = {"panel": 0.05, "tolerance": 1e-8, "theta": c.theta}
        found = thermal_quadrature([c.wire], mu, c.B, c.omega, c.temperature, **finer)
        old, new = (float(abs(v - found.conductance.ravel()).max()) for v in both)
        return old, new, np.nan
    m, e = divmod(i, c.omega.size)
    point = exact.exact(c.wire, c.mu[m], c.B[0], abs(c.omega[e]), c.theta)
    moved = replace(point, mu=point.mu + np.finfo(np.float64).eps * 2 * c.wire.hopping)
    scale = 1.0
    if data.kind == "gradient":
        scale, worst = max(abs(both[0]).max(), SMALLEST), int(np.argmax(abs(both[0] - both[1])))
        G, parameter = divmod(worst, c.wire.sites + 3)
        of = dict(enumerate(("mu", "B", "alpha"), c.wire.sites)).get(parameter, parameter)
        both = [v[worst : worst + 1] for v in both]
        unit = PER_MEV[1] if of == "B" else 1.0

        def solved(q: exact.Exact) -> Any:
            return np.array([exact.derivative(q, c.wire, of)[G + 4 * bool(c.omega[e] < 0)] / unit])
    else:
        solve = exact.determinants if "det" in data.kind else exact.conductances

        def solved(q: exact.Exact) -> Any:
            return np.array([float(x.mid()) for x in solve(q)])

    true = solved(point)
    old, new, move = (float(abs(v - true).max() / scale) for v in (*both, solved(moved)))
    return old, new, move


def pivoting(data: Compared, pivoted: Compared) -> str:
    """Say what is left of the differences where both codes pivot."""
    differ = {data.where(p) for p in np.flatnonzero(~(data.difference <= CLOSE))}
    here = np.array([pivoted.where(p) in differ for p in range(pivoted.difference.size)])
    d, unknown = pivoted.difference[here], pivoted.unknown[here]
    left = d > CLOSE
    return (
        f"  where both pivot {left.sum()} of {len(differ)} differ, "
        f"{(left & (d > 10 * unknown)).sum()} by more than ten roundings of 2t; "
        f"median {np.nanmedian(d):.1e}, largest {np.nanmax(d):.1e}"
    )


def rows(data: Compared) -> Iterator[str]:
    """Yield the row of the table and the worst cases."""
    kind = data.kind
    warm = "mK" in kind
    limit = {"20-60 mK": 1e-4, "20-60 mK, tilted": 2e-5}.get(kind, np.inf)
    finite = [np.isfinite(np.add.reduceat(v, data.starts)) for v in data.values]
    accepted = [f & (e <= limit) for f, e in zip(finite, data.error, strict=True)]
    both, total = accepted[0] & accepted[1], data.error[0] + data.error[1]
    d = np.where(both, data.difference, 0)
    paper = np.repeat(data.cases % 2 == 0, np.diff(data.first))
    beyond = d > CLOSE
    unexplained = beyond & ~(d <= (total if warm else 10 * data.unknown))
    quantiles = [*np.quantile(d[both], [0.5, 0.999, 0.9999, 1]), d[paper].max()]
    numbers = " | ".join(f"{q:.1e}" for q in quantiles)
    yield f"| {kind} | {both.sum()} | {numbers} | {beyond.sum()} | {unexplained.sum()} |"
    for k, name in enumerate(("old", "new")):
        fault = [np.flatnonzero(~accepted[k] & finite[k]), np.flatnonzero(~finite[k])]
        alone = [int((~accepted[k] & accepted[1 - k]).sum()), int((~accepted[k] & paper).sum())]
        yield (
            f"  {name}: {fault[0].size} not within the tolerance, {fault[1].size} no number, of "
            f"both {alone[0]} where the other has one, {alone[1]} of the paper's wires; "
            f"median estimate {np.median(data.error[k][both]):.1e}"
        )
        yield f"    no number: {[data.where(p) for p in fault[1][:8]]}"
    some = np.random.default_rng(33).permutation(np.flatnonzero(beyond))[:20]
    strange = np.flatnonzero(unexplained)
    strange = strange[np.argsort(-d[strange])][:20]
    for name, chosen in (("largest", np.argsort(-d)[:20]), ("random", some), ("strange", strange)):
        found = np.array([truth(data, p) for p in chosen]).reshape(-1, 3)
        nearer = int((found[:, 1] < found[:, 0]).sum())
        yield f"  {name}: the new one is nearer in {nearer} of {len(found)}"
        for p, (old, new, move) in zip(chosen, found, strict=True):
            yield (
                f"    {data.where(p)}: difference {d[p]:.1e}, error of old {old:.1e}, of new "
                f"{new:.1e}, exact moves by {move:.1e}, codes by {data.unknown[p]:.1e}, "
                f"estimates {data.error[0][p]:.1e}, {data.error[1][p]:.1e}"
            )
        if len(found):
            middle = " ".join(f"{x:.1e}" for x in np.median(found, axis=0))
            yield f"    medians of these: old, new, move {middle}"


def main() -> None:
    """Print the report."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("old", type=Path)
    parser.add_argument("new", type=Path)
    parser.add_argument("--kinds", nargs="*", default=list(KINDS), choices=list(KINDS))
    parser.add_argument("--beyond", type=Path, metavar="FILE", help="only list cases that differ")
    parser.add_argument("--pivoted", type=Path, nargs=2, metavar=("OLD", "NEW"))
    options = parser.parse_args()
    beyond = {}
    for kind in options.kinds:
        data = compared(kind, (options.old, options.new))
        if options.beyond is None:
            for row in rows(data):
                print(row, flush=True)
            if options.pivoted is not None and (options.pivoted[0] / f"{kind}.npz").exists():
                print(pivoting(data, compared(kind, options.pivoted)))
        elif "mK" not in kind:
            differ = np.flatnonzero(~(data.difference <= CLOSE))
            beyond[kind] = sorted({data.where(p)[0] for p in differ})
    if options.beyond is not None:
        options.beyond.write_text(json.dumps(beyond), "utf-8")


if __name__ == "__main__":
    main()
