"""What claims ask of a study's table that no row of it holds: fits, losses, correlations.

Each function takes the table's file, and raises a ResultMissingError where the study has not come
far enough.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.stats import permutation_test, spearmanr

from disorder_landscape.claims.claim import ResultMissingError
from disorder_landscape.inference.verdict import CONVERGED
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.studies.components import THIRTY_COMPONENTS
from disorder_landscape.studies.crossings import (
    R2_AIMED_AT,
    fit_power_law,
    learning_curves,
    realizations_needed,
)
from disorder_landscape.studies.fresh_wires import wrong
from disorder_landscape.studies.trainings_table import read_table

SMALL_NOISE = 0.01
"""In e²/h."""
FINE_TUNED = 10
"""Component count that the paper leaves out of its second fit of Fig. 2."""


def fig2_prefactor(table: Path) -> float:
    """Return A of the realizations A·n^p that are needed for R² = 0.77."""
    return fit_power_law(*_needed(table)).prefactor


def fig2_exponent(table: Path) -> float:
    """Return p of the same."""
    return fit_power_law(*_needed(table)).exponent


def fig2_fit(table: Path) -> float:
    """Return R² of this fit, on logarithmic axes."""
    return fit_power_law(*_needed(table)).R2


def fig2_fit_without_ten(table: Path) -> float:
    """Return R² of the fit to all component counts but ten."""
    n, needed = _needed(table)
    return fit_power_law(n[n != FINE_TUNED], needed[n != FINE_TUNED]).R2


def fig2_power_minus_exponential(table: Path) -> float:
    """Return R² of this fit minus that of an exponential, both of log(realizations)."""
    n, needed = _needed(table)
    return fig2_fit(table) - fit_power_law(np.exp(n), needed).R2


def gain_of_last_step(table: Path) -> float:
    """Return by how much R² of ten components rises to the largest number of realizations.

    From the number before it; means over seeds.
    """
    R2: dict[int, list[float]] = defaultdict(list)
    for one in read_table(table):
        if one.components == FINE_TUNED:
            R2[one.realizations].append(one.R2)
    if len(R2) < 2:
        raise ResultMissingError(f"{table.name} has no two sizes of ten components")
    before, last = sorted(R2)[-2:]
    return float(np.mean(R2[last]) - np.mean(R2[before]))


def loss_of_halving(table: Path) -> float:
    """Return the largest loss of R² by half of the filters, over component counts."""
    return float(_losses_of_halving(table)[1].max())


def halving_independent_of_components(table: Path) -> float:
    """Return the p-value of Spearman's rank correlation of component counts with these losses.

    Of all orders that the losses could have, the share with as strong a correlation. Fewer than
    five counts could not show one at 5 %.
    """
    n, loss = _losses_of_halving(table)
    if n.size < 5:
        raise ResultMissingError(f"{table.name} has no five component counts")
    orders = permutation_test(
        (loss,), lambda x: spearmanr(n, x).statistic, permutation_type="pairings", n_resamples=10**4
    )
    return float(orders.pvalue)


def true_answers(table: Path) -> float:
    """Return which part of the inversions that explain their data have found the true disorder.

    At noise up to SMALL_NOISE.
    """
    rows = _rows(table, "verdict")
    explained = rows[(rows["noise"] <= SMALL_NOISE) & (rows["verdict"] == CONVERGED)]
    return float(1 - wrong(explained).mean())


def fixed_combinations(table: Path) -> float:
    """Return the least part of the unknowns that data with SMALL_NOISE fix, over all settings."""
    rows = _rows(table, "fixed")
    some = rows[rows["noise"] == SMALL_NOISE]
    return float((some["fixed"] / some["unknowns"]).min())


def thirty_components(table: Path) -> float:
    """Return R² of V over the inversions of wires of THIRTY_COMPONENTS."""
    rows = _rows(table, "site_error")
    many = rows[rows["components"] == THIRTY_COMPONENTS]
    if many.empty:
        raise ResultMissingError(f"{table.name} has no wires of {THIRTY_COMPONENTS} components yet")
    return float(1 - (many["site_error"] ** 2).sum() / (many["prior_error"] ** 2).sum())


DERIVED: dict[str, Callable[[Path], float]] = {
    function.__name__: function
    for function in (
        fig2_prefactor,
        fig2_exponent,
        fig2_fit,
        fig2_fit_without_ten,
        fig2_power_minus_exponential,
        gain_of_last_step,
        loss_of_halving,
        halving_independent_of_components,
        true_answers,
        fixed_combinations,
        thirty_components,
    )
}
"""What a claim can name, by name."""


def _rows(table: Path, column: str) -> pd.DataFrame:
    """Return the rows of a study that is no training."""
    rows = pd.read_csv(table)
    if column not in rows or rows.empty:
        raise ResultMissingError(f"{table.name} has no rows yet")
    return rows


def _needed(table: Path) -> tuple[FloatArray, FloatArray]:
    """Return component counts and the realizations that each needs, as Fig. 2 shows them."""
    n, needed = realizations_needed(learning_curves(read_table(table)))
    if len(n) < 3:
        raise ResultMissingError(f"{table.name} has no three crossings of R² = {R2_AIMED_AT}")
    return n, needed


def _losses_of_halving(table: Path) -> tuple[FloatArray, FloatArray]:
    """Return component counts, and R² at their largest width minus R² at half of it.

    Means over seeds; counts without half of their largest width are left out.
    """
    R2: dict[int, dict[float, list[float]]] = defaultdict(lambda: defaultdict(list))
    for one in read_table(table):
        R2[one.components][one.width_fraction].append(one.R2)
    losses = {
        components: np.mean(of[max(of)]) - np.mean(of[max(of) / 2])
        for components, of in sorted(R2.items())
        if max(of) / 2 in of
    }
    if not losses:
        raise ResultMissingError(f"{table.name} has no width and half of it")
    return np.array(list(losses), dtype=np.float64), np.array(list(losses.values()))
