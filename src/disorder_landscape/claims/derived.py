"""What claims ask of a study's table that no row of it holds: fits, losses, correlations.

Each function takes the table's file, and raises a ResultMissingError where the study has not come
far enough.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import linregress, spearmanr

from disorder_landscape.claims.claim import ResultMissingError
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.studies.table import read_table

FINE_TUNED = 10
"""Component count that the paper leaves out of its second fit of Fig. 2."""
R2_AIMED_AT = 0.77
"""Of Figs. 2 and S2."""


def fig2_prefactor(table: Path) -> float:
    """Return A of the realizations A·n^p that are needed for R² = 0.77."""
    return float(np.exp(_straight_line(*_log_crossings(table)).intercept))


def fig2_exponent(table: Path) -> float:
    """Return p of the same."""
    return float(_straight_line(*_log_crossings(table)).slope)


def fig2_fit(table: Path) -> float:
    """Return R² of this fit, on logarithmic axes."""
    return float(_straight_line(*_log_crossings(table)).rvalue ** 2)


def fig2_fit_without_ten(table: Path) -> float:
    """Return R² of the fit to all component counts but ten."""
    log_n, log_needed = _log_crossings(table)
    kept = log_n != np.log(FINE_TUNED)
    return float(_straight_line(log_n[kept], log_needed[kept]).rvalue ** 2)


def fig2_power_minus_exponential(table: Path) -> float:
    """Return R² of this fit minus that of an exponential, both of log(realizations)."""
    log_n, log_needed = _log_crossings(table)
    exponential = _straight_line(np.exp(log_n), log_needed)
    return fig2_fit(table) - float(exponential.rvalue**2)


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


def _log_crossings(table: Path) -> tuple[FloatArray, FloatArray]:
    """Return logarithms of component counts and of the realizations that each needs.

    Geometric means over seeds, each interpolated in its learning curve, linearly in log(size).
    Component counts of which a seed's curve does not cross R² = 0.77 are left out.
    """
    curves: dict[int, dict[int, dict[int, float]]] = defaultdict(lambda: defaultdict(dict))
    for one in read_table(table):
        curves[one.components][one.seed][one.realizations] = one.R2
    crossings: dict[int, float] = {}
    for components, seeds in sorted(curves.items()):
        logs = [_log_crossing(dict(sorted(curve.items()))) for curve in seeds.values()]
        if np.isfinite(logs).all():
            crossings[components] = float(np.mean(logs))
    if len(crossings) < 3:
        raise ResultMissingError(f"{table.name} has no three crossings of R² = {R2_AIMED_AT}")
    return np.log(list(crossings)), np.array(list(crossings.values()))


def _log_crossing(curve: dict[int, float]) -> float:
    """Return log(size) at which a learning curve first reaches R² = 0.77, NaN if nowhere."""
    log_size, R2 = np.log(list(curve)), np.maximum.accumulate(list(curve.values()))
    if not R2[0] < R2_AIMED_AT <= R2[-1]:
        return float("nan")
    after = int(np.argmax(R2 >= R2_AIMED_AT))
    return float(np.interp(R2_AIMED_AT, R2[after - 1 : after + 1], log_size[after - 1 : after + 1]))


def _straight_line(x: FloatArray, y: FloatArray) -> Any:
    """Return SciPy's fit of a straight line: slope, intercept, rvalue."""
    return linregress(x, y)


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
