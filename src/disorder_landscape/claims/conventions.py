"""What each convention that the paper leaves open does to R², each varied alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from disorder_landscape.arguments import require
from disorder_landscape.claims.claim import claim_of, load_claims
from disorder_landscape.claims.table import markdown, number
from disorder_landscape.runs import REPOSITORY
from disorder_landscape.studies.trainings_table import Result, read_table

TABLE = REPOSITORY / "results" / "conventions.csv"
REFERENCE = "reference"
"""The run that all others differ from in one convention."""
COLUMNS = ("convention", "R²", "change", "ΔV (meV)", "ΔV/√(1−R²)", "Δα (meV nm)", "Δα/√(1−R²)")


def conventions_table(path: Path = TABLE) -> str:
    """Return a Markdown table: the paper's numbers, the reference and what differs from it.

    Means over seeds; ± is half of the distance between the lowest and the highest. Where all labels
    are predicted alike, an error over √(1−R²) is the spread of what is predicted, whatever R²: the
    amplitude of V, or the range of α. It tells conventions apart that R² does not.

    Raises
    ------
    ArgumentError
        If the study has no reference.
    """
    results = read_table(path)
    names = list(dict.fromkeys(one.name for one in results))
    require(REFERENCE in names, "conventions", f"have a run named {REFERENCE}", f"see '{path}'")
    R2_of_reference = _mean([one for one in results if one.name == REFERENCE], "R2")
    claims = load_claims()
    R2, delta_V, delta_alpha = (
        float(claim_of(name, claims).paper or np.nan)
        for name in ("r2-five", "delta-v-five", "delta-alpha")
    )
    rows = [("the paper, 8,000 wires", number(R2), "", *_errors(R2, delta_V, delta_alpha))]
    for name in names:
        runs = [one for one in results if one.name == name]
        R2, delta_V, delta_alpha = (_mean(runs, key) for key in ("R2", "delta_V", "delta_alpha"))
        of_runs = [one.R2 for one in runs]
        spread = f" ± {(max(of_runs) - min(of_runs)) / 2:.4f}" if len(runs) > 1 else ""
        change = "" if name == REFERENCE else f"{R2 - R2_of_reference:+.3f}".replace("-", "−")
        rows.append((name, f"{R2:.4f}{spread}", change, *_errors(R2, delta_V, delta_alpha)))
    return markdown(COLUMNS, rows)


def _mean(runs: list[Result], key: str) -> float:
    return float(np.mean([getattr(run, key) for run in runs]))


def _errors(R2: float, delta_V: float, delta_alpha: float) -> tuple[str, ...]:
    """Return the cells of both errors, as they are and over √(1−R²)."""
    share = np.sqrt(1 - R2)
    errors = (delta_V, delta_V / share, delta_alpha, delta_alpha / share)
    return tuple(f"{error:.{digits}f}" for error, digits in zip(errors, (4, 2, 3, 2), strict=True))
