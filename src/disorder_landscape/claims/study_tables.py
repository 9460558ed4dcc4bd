"""What the inversions of fresh wires came to, and how much the data say of more components."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import pandas as pd

from disorder_landscape.claims.table import markdown
from disorder_landscape.inference.verdict import CONVERGED
from disorder_landscape.inference.verification.comparison import UNLIKELY
from disorder_landscape.runs import REPOSITORY
from disorder_landscape.studies.calibration import coverage, joint_coverage
from disorder_landscape.studies.fresh_wires import wrong
from disorder_landscape.studies.other_wires import KINDS
from disorder_landscape.studies.unmodelled import MODEL_ALONE

INVERSIONS = REPOSITORY / "results" / "inversions.csv"
COMPONENTS = REPOSITORY / "results" / "components.csv"
UNIQUENESS = REPOSITORY / "results" / "uniqueness.csv"
UNMODELLED = REPOSITORY / "results" / "unmodelled.csv"
SHOWN = (0.01, 0.1)
"""Noise of which the table of uniqueness has rows, in e²/h."""
WITHIN = 5.0
"""Error of V in µeV that nearly all answers at little noise should be within."""
ACCURACY_COLUMNS = (
    "model, noise (e²/h)",
    "wires",
    "network: V off by (µeV)",
    "inversion: median, 90 %, worst",
    "its own error bar",
    "1 − R²: network, inversion",
    "converged",
    "wrong: flagged, unflagged",
    "within 50, 80, 95 % (%): each unknown; all at once",
    "within 5 µeV",
    "α off by (meV nm): network, inversion",
    "seconds, one core",
)
COMPONENTS_COLUMNS = (
    "components, noise (e²/h)",
    "wires",
    "prior: V off by (µeV)",
    "inversion: median, worst",
    "its own error bar",
    "converged",
    "wrong: flagged, unflagged",
    "seconds, one core",
)
UNMODELLED_COLUMNS = (
    "inverted with",
    "in truth",
    "wires",
    "G changed by (noise)",
    "V off by (µeV): median, worst",
    "wrong",
    "of these flagged: verdict, K'",
    "missed",
    "right, but flagged: verdict, K'",
)


def accuracy_table(path: Path = INVERSIONS) -> str:
    """Return a Markdown table of the inversions, a row for each model and noise."""
    rows = []
    for (model, noise), some in pd.read_csv(path).groupby(["model", "noise"]):
        error = 1e3 * some["site_error"]
        rows.append(
            (
                f"{str(model).replace('_', ' ')}, {noise:g}",
                str(len(some)),
                f"{1e3 * some['network_error'].median():.3g}",
                ", ".join(f"{x:.2g}" for x in (error.median(), error.quantile(0.9), error.max())),
                f"{1e3 * some['spread'].median():.2g}",
                f"{some['network_scaled_error'].mean():.2g}, {some['scaled_error'].mean():.1g}",
                *_verdicts(some),
                _within(some) if noise > 0 else "–",
                f"{100 * (error < WITHIN).mean():.3g} %",
                _alpha_errors(some),
                f"{some['seconds'].median():.0f}",
            )
        )
    return markdown(ACCURACY_COLUMNS, rows)


def _within(some: pd.DataFrame) -> str:
    """Return the coverage of each unknown, and of all at once, in percent."""
    return "; ".join(
        ", ".join(f"{100 * part:.0f}" for part in parts)
        for parts in (coverage(some), joint_coverage(some))
    )


def _alpha_errors(some: pd.DataFrame) -> str:
    """Return by how much α is off, medians; nothing where it is known."""
    if not some["network_alpha_error"].any():
        return "–"
    columns = ("network_alpha_error", "alpha_error")
    return ", ".join(f"{some[column].median():.2g}" for column in columns)


def _verdicts(some: pd.DataFrame) -> tuple[str, str]:
    """Return how many converged, and how many are wrong: flagged, unflagged."""
    is_wrong, is_converged = wrong(some), some["verdict"] == CONVERGED
    return (
        f"{100 * is_converged.mean():.3g} %",
        f"{(is_wrong & ~is_converged).sum()}, {(is_wrong & is_converged).sum()}",
    )


def components_table(path: Path = COMPONENTS) -> str:
    """Return a Markdown table of the inversions without a network, of more components."""
    rows = [
        (
            f"{components}, {noise:g}",
            str(len(some)),
            f"{1e3 * some['prior_error'].median():.0f}",
            f"{1e3 * some['site_error'].median():.2g}, {1e3 * some['site_error'].max():.2g}",
            f"{1e3 * some['spread'].median():.2g}",
            *_verdicts(some),
            f"{some['seconds'].median():.0f}",
        )
        for (components, noise), some in pd.read_csv(path).groupby(["components", "noise"])
    ]
    return markdown(COMPONENTS_COLUMNS, rows)


def unmodelled_table(path: Path = UNMODELLED) -> str:
    """Return a Markdown table of what is noticed of wires that the model does not describe."""
    table = pd.read_csv(path)
    rows = []
    for prior, (kind, truth) in product(table["prior"].unique(), KINDS.items()):
        some = table[(table["kind"] == kind) & (table["prior"] == prior)]
        if some.empty:
            continue
        is_wrong = wrong(some)
        by_verdict, by_further = some["verdict"] != CONVERGED, some["p_predictive"] <= UNLIKELY
        error = 1e3 * some["site_error"]
        rows.append(
            (
                "the model alone" if prior == MODEL_ALONE else f"`{prior}.toml`",
                truth,
                str(len(some)),
                f"{some['departure'].median():.2g}",
                f"{error.median():.2g}, {error.max():.2g}",
                str(is_wrong.sum()),
                f"{(is_wrong & by_verdict).sum()}, {(is_wrong & by_further).sum()}",
                str((is_wrong & ~by_verdict & ~by_further).sum()),
                f"{(~is_wrong & by_verdict).sum()}, {(~is_wrong & by_further).sum()}",
            )
        )
    return markdown(UNMODELLED_COLUMNS, rows)


def uniqueness_table(path: Path = UNIQUENESS) -> str:
    """Return a Markdown table: combinations that the data fix, V's error bar (medians)."""
    table = pd.read_csv(path)
    settings = sorted(
        {(points, biases) for points, biases in table[["points", "biases"]].to_numpy()}
    )
    columns = ["components, noise (e²/h)"]
    columns += [f"{points}×{points}×{biases}" for points, biases in settings]
    rows = []
    shown = table[table["noise"].isin(SHOWN)]
    for (components, noise), some in shown.groupby(["components", "noise"]):
        cells = [f"{components}, {noise:g}"]
        for points, biases in settings:
            at = some[(some["points"] == points) & (some["biases"] == biases)]
            unknowns = at["unknowns"].iloc[0] if len(at) else 0
            bar = 1e3 * at["spread"].median()
            cells.append(
                f"{at['fixed'].median():.0f} of {unknowns}: {bar:.{0 if bar >= 10 else 1}f} µeV"
                if len(at)
                else ""
            )
        rows.append(tuple(cells))
    return markdown(tuple(columns), rows)
