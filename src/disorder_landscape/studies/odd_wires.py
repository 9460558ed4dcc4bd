"""Kind "odd_wires": how right the solver is over the whole range that parameters are accepted in.

At T = 0 the conductances of one random wire, μ, B, angle and energy after the other are compared
with those of Kwant; where they do not agree to 1e-6 e²/h, numbers of 600 bits tell who is right
(`exact`). Where these change as much when μ and that of the leads do by some roundings of 2t, no
solver can know them, and a wire is not counted. At T > 0 the average in closed form is compared
with the integral by adaptive quadrature, and its estimated error with the true one.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.parts import needs
from disorder_landscape.solver import compiled
from disorder_landscape.solver.quadrature import thermal_quadrature
from disorder_landscape.solver.routes import closed_form
from disorder_landscape.studies.fingerprint import fingerprint
from disorder_landscape.studies.odd_cases import any_case, any_energy, warm_case
from disorder_landscape.studies.rows import Row
from disorder_landscape.studies.study import Derived, Place, Plan

CLOSE = 1e-6
"""Difference in e²/h that is allowed."""
KNOWN = CLOSE / 10
"""How far a conductance must be known to count."""
ROUNDINGS = 16
"""By so many roundings of 2t μ is moved, in wire and leads, to see whether it can be known."""
FACTOR, SMALLEST = 3.0, 1e-5
"""An error beyond SMALLEST (e²/h) must not be larger than so many times its estimate."""
SHARE_BEYOND = 1e-3
"""Of the accepted averages at most this part may be."""
SHOWN = 10
"""Worst cases that are printed."""

Natural = Annotated[int, Field(ge=0)]


@dataclass(frozen=True)
class Task:
    """A wire, and what the solver is compared with: "kwant" or "quadrature"."""

    compared_with: str
    index: int


class OddWiresPlan(Plan):
    """A search among odd wires."""

    kind: Literal["odd_wires"]
    kwant: Natural
    """Wires at T = 0."""
    quadrature: Natural
    """Averages at T > 0."""
    seed: Natural
    """Another one is another search."""

    keys: ClassVar = ("compared_with", "index")

    def tasks(self) -> Sequence[Task]:
        """Return the wires."""
        counts = {"kwant": self.kwant, "quadrature": self.quadrature}
        return [Task(name, index) for name, count in counts.items() for index in range(count)]

    def folder(self, place: Place) -> Path:
        """Return a folder of these very solvers and cases."""
        settings = self.model_dump_json(include={"seed"})
        made_by = fingerprint("odd_wires", "odd_cases", "exact", settings=settings)
        return place.build / "studies" / made_by

    def rows(self, task: Task, place: Place) -> list[dict[str, object]]:
        """Compare one wire."""
        compare = {"kwant": compare_with_kwant, "quadrature": compare_with_quadrature}
        found = compare[task.compared_with](self.seed, task.index)
        return [{"compared_with": task.compared_with, "index": task.index, **found}]

    def derived(self, rows: Sequence[Row], place: Place) -> Derived:
        """Return the report, and whether both bounds hold."""
        cold, warm = (
            [_numbers(row) for row in rows if row["compared_with"] == name]
            for name in ("kwant", "quadrature")
        )
        text, passed = report(cold, warm)
        return Derived(lines=text.splitlines(), passed=passed)


def compare_with_kwant(seed: int, index: int) -> dict[str, Any]:
    """Return the largest difference of the conductances; and who is right, where it is large."""
    from disorder_landscape.solver import kwant_reference

    with needs("dev"):
        from disorder_landscape.studies.exact import exact_conductances

    (wire, mu, B, theta), omega = any_case(seed, index), any_energy(seed, index)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of Kwant, on its eigenvectors
        try:
            of_kwant = kwant_reference.bare_conductance([wire], mu, B, omega, theta)
        except Exception as error:  # LAPACK, or modes that Kwant cannot tell apart
            return {"failed": f"{type(error).__name__}: {error}"}
    found = compiled.bare_conductance([wire], mu, B, omega, theta)
    row = {"error": _largest(found - of_kwant), "omega": float(omega[0])}
    if row["error"] > CLOSE:
        move = ROUNDINGS * np.finfo(np.float64).eps * (2 * wire.hopping + abs(mu[0]))
        other = replace(wire, lead_mu=wire.lead_mu + move)
        true = exact_conductances(wire, mu[0], B[0], omega[0], theta)
        moved = exact_conductances(other, mu[0] + move, B[0], omega[0], theta)
        row |= {
            "unknown": _largest(moved - true),
            "true error": _largest(found - true),
            "of Kwant": _largest(of_kwant - true),
        }
    return row


def compare_with_quadrature(seed: int, index: int) -> dict[str, Any]:
    """Return the largest error of the average in closed form and its estimate; NaN if rejected."""
    (wire, mu, B, theta), bias, temperature = warm_case(seed, index)
    arguments = [wire], mu, B, bias, temperature
    G, estimate, _ = closed_form(*arguments, theta)
    if not estimate.item() <= compiled.core.TOLERANCE:
        return {"error": None}
    exact = thermal_quadrature(*arguments, theta=theta)
    error = _largest(G - exact.conductance)
    return {
        "error": error,
        "estimate": estimate.item(),
        "integral": exact.error.item(),
    }


def _largest(difference: FloatArray) -> float:
    """Return the largest absolute value; a number larger than any, where there is NaN."""
    largest = float(abs(difference).max())
    return largest if np.isfinite(largest) else 1e300


def _numbers(row: Row) -> dict[str, Any]:
    """Return what a row holds, as numbers where they are."""
    words = ("compared_with", "failed")
    return {
        name: text if name in words else float(text) for name, text in row.items() if text != ""
    }


def report(cold: list[dict[str, Any]], warm: list[dict[str, Any]]) -> tuple[str, bool]:
    """Return the report, and whether both bounds hold."""
    apart = [row for row in cold if row.get("unknown", np.inf) <= KNOWN]
    wrong = [row for row in apart if row["true error"] > CLOSE]
    accepted = [row for row in warm if "error" in row]
    beyond = [
        row
        for row in accepted
        if row["error"] > SMALLEST and row["error"] > FACTOR * row["estimate"] + row["integral"]
    ]
    lines = [
        f"T = 0, against Kwant: {len(cold)} wires; Kwant failed at "
        f"{sum('failed' in row for row in cold)}; {len(apart)} that can be known to {KNOWN:g} "
        f"differ by more than {CLOSE:g} e²/h, and the solver is off by as much in {len(wrong)}",
        *(str(row) for row in sorted(wrong, key=lambda row: -row["error"])[:SHOWN]),
        f"T > 0, against quadrature: {len(warm)} sets, {len(accepted)} accepted, of {len(beyond)} "
        f"the error is beyond {SMALLEST:g} e²/h and {FACTOR:g} times the estimate; largest "
        f"{max((row['error'] for row in accepted), default=0.0):.1e}",
        *(str(row) for row in sorted(beyond, key=lambda row: -row["error"])[:SHOWN]),
    ]
    return "\n".join(lines), not wrong and len(beyond) <= SHARE_BEYOND * len(accepted)
