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
from disorder_landscape.claims.value import FEWEST_SEEDS, Value, with_resampled
from disorder_landscape.inference.verdict import CONVERGED
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.runs import TEN
from disorder_landscape.studies.components import THIRTY_COMPONENTS
from disorder_landscape.studies.crossings import (
    R2_AIMED_AT,
    learning_curves,
    power_laws,
    realizations_needed,
    resampled_needed,
)
from disorder_landscape.studies.fresh_wires import wrong
from disorder_landscape.studies.trainings_table import read_table

SMALL_NOISE = 0.01
"""In e²/h."""
DRAWS = 2000
"""Of seeds, for an interval: its ends are then known to a tenth of its width."""
FINE_TUNED = 10
"""Component count that the paper leaves out of its second fit of Fig. 2."""


def fig2_prefactor(table: Path) -> Value:
    """Return A of the realizations A·n^p that are needed for R² = 0.77."""
    return _of_needed(table, lambda n, needed: power_laws(n, needed)[0])


def fig2_exponent(table: Path) -> Value:
    """Return p of the same."""
    return _of_needed(table, lambda n, needed: power_laws(n, needed)[1])


def fig2_fit(table: Path) -> Value:
    """Return R² of this fit, on logarithmic axes."""
    return _of_needed(table, lambda n, needed: power_laws(n, needed)[2])


def fig2_fit_without_ten(table: Path) -> Value:
    """Return R² of the fit to all component counts but ten."""
    return _of_needed(
        table, lambda n, needed: power_laws(n[n != FINE_TUNED], needed[..., n != FINE_TUNED])[2]
    )


def fig2_power_minus_exponential(table: Path) -> Value:
    """Return R² of this fit minus that of an exponential, both of log(realizations)."""
    return _of_needed(
        table, lambda n, needed: power_laws(n, needed)[2] - power_laws(np.exp(n), needed)[2]
    )


def gain_of_last_step(table: Path) -> Value:
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
    return Value(float(np.mean(R2[last]) - np.mean(R2[before])))


def loss_of_halving(table: Path) -> Value:
    """Return the largest loss of R² by half of the filters, over component counts."""
    losses = _losses_of_halving(table)
    largest = max(float(of.mean()) for of in losses.values())
    if min(of.size for of in losses.values()) < FEWEST_SEEDS:
        return Value(largest)
    rng = np.random.default_rng(0)
    means = [rng.choice(of, (DRAWS, of.size)).mean(axis=1) for of in losses.values()]
    return with_resampled(largest, np.max(means, axis=0))


def halving_independent_of_components(table: Path) -> Value:
    """Return the p-value of Spearman's rank correlation of component counts with these losses.

    Of all orders that the losses could have, the share with as strong a correlation. Fewer than
    five counts could not show one at 5 %.
    """
    losses = _losses_of_halving(table)
    if len(losses) < 5:
        raise ResultMissingError(f"{table.name} has no five component counts")
    n, loss = list(losses), [of.mean() for of in losses.values()]
    orders = permutation_test(
        (loss,), lambda x: spearmanr(n, x).statistic, permutation_type="pairings", n_resamples=10**4
    )
    return Value(float(orders.pvalue))


def true_answers(table: Path) -> Value:
    """Return which part of the inversions that explain their data have found the true disorder.

    At noise up to SMALL_NOISE.
    """
    rows = _rows(table, "verdict")
    explained = rows[(rows["noise"] <= SMALL_NOISE) & (rows["verdict"] == CONVERGED)]
    return Value(float(1 - wrong(explained).mean()))


def visibility_of_inversions(table: Path) -> Value:
    """Return how well the answers for ten components are topological where the wires are.

    At noise of SMALL_NOISE; as `visibility_match`.
    """
    rows = _rows(table, "either_topological").dropna(subset="either_topological")
    some = rows[(rows["noise"] == SMALL_NOISE) & (rows["model"] == TEN)]
    if some.empty:
        raise ResultMissingError(f"{table.name} has no such wires of ten components yet")
    return Value(float(some["both_topological"].sum() / some["either_topological"].sum()))


def fixed_combinations(table: Path) -> Value:
    """Return the least part of the unknowns that data with SMALL_NOISE fix, over all settings."""
    rows = _rows(table, "fixed")
    some = rows[rows["noise"] == SMALL_NOISE]
    return Value(float((some["fixed"] / some["unknowns"]).min()))


def thirty_components(table: Path) -> Value:
    """Return R² of V over the inversions of wires of THIRTY_COMPONENTS."""
    rows = _rows(table, "site_error")
    many = rows[rows["components"] == THIRTY_COMPONENTS]
    if many.empty:
        raise ResultMissingError(f"{table.name} has no wires of {THIRTY_COMPONENTS} components yet")
    return Value(float(1 - (many["site_error"] ** 2).sum() / (many["prior_error"] ** 2).sum()))


DERIVED: dict[str, Callable[[Path], Value]] = {
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
        visibility_of_inversions,
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


def _of_needed(table: Path, statistic: Callable[[FloatArray, FloatArray], FloatArray]) -> Value:
    """Return a statistic of component counts and the realizations that each needs (Fig. 2)."""
    curves = learning_curves(read_table(table))
    n, needed = realizations_needed(curves)
    if len(n) < 3:
        raise ResultMissingError(f"{table.name} has no three crossings of R² = {R2_AIMED_AT}")
    return with_resampled(statistic(n, needed), statistic(n, resampled_needed(curves, DRAWS)))


def _losses_of_halving(table: Path) -> dict[int, FloatArray]:
    """Return R² at the largest width minus R² at half of it, over seeds, by component count.

    The same seed chooses the same wires. Counts without half of their largest width are left out.
    """
    R2: dict[int, dict[float, dict[int, float]]] = defaultdict(lambda: defaultdict(dict))
    for one in read_table(table):
        R2[one.components][one.width_fraction][one.seed] = one.R2
    losses: dict[int, FloatArray] = {}
    for components, of in sorted(R2.items()):
        widest = max(of)
        seeds = sorted(of[widest].keys() & of.get(widest / 2, {}).keys())
        if seeds:
            losses[components] = np.array([of[widest][s] - of[widest / 2][s] for s in seeds])
    if not losses:
        raise ResultMissingError(f"{table.name} has no width and half of it")
    return losses
