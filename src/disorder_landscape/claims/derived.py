"""What claims ask of a study's table that no row of it holds: fits, losses, correlations.

Each function takes the table's file, and raises a ResultMissingError where the study has not come
far enough.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.stats import linregress, spearmanr

from disorder_landscape.claims.claim import ResultMissingError
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.studies.crossings import PowerLaw, fit_power_law, learning_curves
from disorder_landscape.studies.table import read_table

FINE_TUNED = 10
"""Component count that the paper leaves out of its second fit of Fig. 2."""


def fig2_prefactor(table: Path) -> float:
    """Return A of the realizations A·n^p that are needed for R² = 0.77."""
    return _power_law(table).prefactor


def fig2_exponent(table: Path) -> float:
    """Return p of the same."""
    return _power_law(table).exponent


def fig2_fit(table: Path) -> float:
    """Return R² of this fit."""
    return _power_law(table).R2


def fig2_fit_without_ten(table: Path) -> float:
    """Return R² of the fit to all component counts but ten."""
    n, needed = _crossings(table)
    kept = n != FINE_TUNED
    return fit_power_law(n[kept], needed[kept]).R2


def fig2_power_minus_exponential(table: Path) -> float:
    """Return R² of this fit minus that of an exponential, both of log(realizations)."""
    n, needed = _crossings(table)
    return _power_law(table).R2 - float(linregress(n, np.log(needed)).rvalue ** 2)


def gain_of_last_step(table: Path) -> float:
    """Return by how much R² of ten components rises to the largest number of realizations.

    From the number before it; means over seeds.
    """
    curves = [one for one in learning_curves(read_table(table)) if one.components == FINE_TUNED]
    if not curves or curves[0].realizations.size < 2:
        raise ResultMissingError(f"{table.name} has no two sizes of ten components")
    R2 = curves[0].R2.mean(axis=0)
    return float(R2[-1] - R2[-2])


def loss_of_halving(table: Path) -> float:
    """Return the largest loss of R² by half of the filters, over component counts."""
    return float(_losses_of_halving(table)[1].max())


def halving_independent_of_components(table: Path) -> float:
    """Return the p-value of Spearman's rank correlation of component counts with these losses."""
    n, loss = _losses_of_halving(table)
    if n.size < 3:
        raise ResultMissingError(f"{table.name} has no three component counts")
    return float(spearmanr(n, loss).pvalue)


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
    )
}
"""What a claim can name, by name."""


def _crossings(table: Path) -> tuple[FloatArray, FloatArray]:
    """Return component counts and the realizations that each needs, geometric means over seeds.

    Counts of which a seed's curve does not cross R² = 0.77 are left out, as in Fig. 2.
    """
    curves = {
        one.components: one.crossings()
        for one in learning_curves(read_table(table))
        if np.isfinite(one.crossings()).all()
    }
    if len(curves) < 3:
        raise ResultMissingError(f"{table.name} has no three crossings of R² = 0.77")
    needed = [np.exp(np.log(of).mean()) for of in curves.values()]
    return np.array(list(curves), dtype=np.float64), np.array(needed)


def _power_law(table: Path) -> PowerLaw:
    return fit_power_law(*_crossings(table))


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
