"""What the errors of thermal averages come to: numbers, their report, and a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import style
from matplotlib.figure import Figure

from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.pictures import write_picture
from disorder_landscape.runs import REPOSITORY
from disorder_landscape.studies.accuracy_cases import KINDS

CLOSE, WORST = 1e-4, 1e-3
"""Errors in e²/h: of nearly all conductances, and of every one."""
SHARE_CLOSE = 0.999
"""Share of conductances that must be within CLOSE."""
MOST = 600
"""Energies that no closed form takes more of, and no quadrature fewer."""
QUANTILES = (0.5, 0.9, 0.99, 0.999, 1.0)


def summary(measured: dict[str, FloatArray]) -> dict[str, Any]:
    """Return the numbers of the report; errors in e²/h."""
    kind, error = measured["kind"], measured["error"]
    groups = {"all": np.ones(kind.size, dtype=bool)}
    groups |= {name: kind == k for k, name in enumerate(KINDS) if (kind == k).any()}
    share, largest = float(np.mean(error <= CLOSE)), float(error.max())
    finer = ~np.isnan(measured["converged"])
    brute_force = {
        "wires_integrated_finer": int(finer.sum()),
        "largest_difference_from_finer": float(measured["converged"][finer].max()),
        "quantiles_of_difference": _quantiles(measured["converged"][finer]),
        "largest_estimate": float(measured["brute"].max()),
        "largest_estimate_of_finer": float(measured["finest"][finer].max()),
    }
    return {
        "wires": int(kind.size),
        "conductances": int(error.size),
        "share_within_1e-4": share,
        "largest_error": largest,
        "bounds": {"share_within_1e-4": SHARE_CLOSE, "largest_error": WORST},
        "passed": bool(share >= SHARE_CLOSE and largest <= WORST),  # NaN fails both
        "kinds": {
            name: _group({key: values[of] for key, values in measured.items()})
            for name, of in groups.items()
        },
        "brute_force": brute_force,
    }


def _group(measured: dict[str, FloatArray]) -> dict[str, Any]:
    """Return the numbers of one kind of wire; a set is one wire with its five biases."""
    error, estimate, energies = (measured[name] for name in ("error", "estimate", "energies"))
    worst = error.max(axis=(1, 2))
    rational = energies <= MOST
    numbers, sets = np.unique(energies[rational], return_counts=True)
    return {
        "sets": int(estimate.size),
        "share_within_1e-4": float(np.mean(error <= CLOSE)),
        "quantiles_of_error": _quantiles(error),
        "quantiles_of_estimate": _quantiles(estimate),
        "sets_with_error_above_estimate": int(np.sum(worst > estimate)),
        "of_these_by_more_than_brute_force_may_err": int(
            np.sum(worst - measured["brute"] > estimate)
        ),
        "largest_error_over_estimate": float(np.max(worst / estimate)),
        "mean_energies": float(energies.mean()),
        "mean_energies_without_quadrature": float(energies[rational].mean()),
        "sets_by_energies": {
            str(int(number)): int(count) for number, count in zip(numbers, sets, strict=True)
        },
        "sets_with_quadrature": int(np.sum(~rational)),
    }


def _quantiles(values: FloatArray) -> dict[str, float]:
    return {f"{q:g}": float(np.quantile(values, q)) for q in QUANTILES}


def report(numbers: dict[str, Any]) -> str:
    """Return the summary as text."""
    whole, brute = numbers["kinds"]["all"], numbers["brute_force"]
    share, largest = numbers["share_within_1e-4"], numbers["largest_error"]
    verdicts = {True: "holds", False: "FAILS"}
    sets = numbers["wires"]
    lines = [
        "Conductances at finite temperature against the thermal integral by brute force, in e²/h",
        "",
        f"{numbers['wires']} wires, {numbers['conductances']} conductances",
        f"within {CLOSE:g}: {100 * share:.4f} % (at least {100 * SHARE_CLOSE:g} %: "
        f"{verdicts[share >= SHARE_CLOSE]})",
        f"largest error: {largest:.2e} (at most {WORST:g}: {verdicts[largest <= WORST]})",
        "",
        f"{'quantile':24}" + "".join(f"{100 * q:>9g} %" for q in QUANTILES),
        f"{'error of a conductance':24}" + _row(whole["quantiles_of_error"]),
        f"{'estimate of a set':24}" + _row(whole["quantiles_of_estimate"]),
        "",
        "A set is one wire, μ and B with its biases. Its error, of the worst of its conductances,",
        f"is above the estimate in {whole['sets_with_error_above_estimate']} of {sets} sets; "
        f"by more than the brute-force integral",
        f"itself may be wrong in {whole['of_these_by_more_than_brute_force_may_err']}. "
        f"It is {whole['largest_error_over_estimate']:.2f} times the estimate at most.",
        "",
        "Energies that a set took, and how many sets did; and by quadrature, where no model was",
        "accepted:",
        "  "
        + ", ".join(f"{energies}: {n}" for energies, n in whole["sets_by_energies"].items())
        + f"; quadrature: {whole['sets_with_quadrature']} "
        f"({100 * whole['sets_with_quadrature'] / sets:.2f} %)",
        "",
        f"{'wires':10}{'sets':>5}{'median':>10}{'99 %':>10}{'largest':>10}{'> 1e-4':>9}"
        f"{'> est.':>7}{'times':>10}{'energies':>10}{'quadr.':>8}",
    ]
    for name, group in numbers["kinds"].items():
        error = group["quantiles_of_error"]
        lines.append(
            f"{name:10}{group['sets']:5d}{error['0.5']:10.1e}{error['0.99']:10.1e}{error['1']:10.1e}"
            f"{100 * (1 - group['share_within_1e-4']):7.3f} %"
            f"{group['sets_with_error_above_estimate']:7d}"
            f"{group['largest_error_over_estimate']:10.2f}"
            f"{group['mean_energies_without_quadrature']:10.1f}{group['sets_with_quadrature']:8d}"
        )
    lines += [
        "(components, amplitude; energies: mean per set without those of quadrature)",
        "",
        f"Brute force: its own estimate is at most {brute['largest_estimate']:.1e}. A finer run of "
        f"{brute['wires_integrated_finer']} wires,",
        "16 kT to both sides and across the gap, of an estimate of "
        f"{brute['largest_estimate_of_finer']:.1e} or less, differs by",
        f"{brute['quantiles_of_difference']['0.5']:.1e} (median), "
        f"{brute['largest_difference_from_finer']:.1e} (largest).",
    ]
    return "\n".join(lines)


def _row(quantiles: dict[str, float]) -> str:
    return "".join(f"{value:11.1e}" for value in quantiles.values())


def draw(measured: dict[str, FloatArray]) -> Figure:
    """Draw (a) histograms of error and estimate of every set, (b) the share of larger errors."""
    error = measured["error"]
    worst, estimate = error.max(axis=(1, 2)), measured["estimate"]
    figure = Figure(figsize=(7.06, 2.7), layout="constrained")
    a, b = figure.subplots(1, 2)
    end = 3 * max(WORST, worst.max())
    bins = np.geomspace(1e-9, end, 65)
    a.hist(np.clip(worst, bins[0], bins[-1]), bins, color="#4477AA", label="error")
    a.hist(estimate, bins, histtype="step", color="#CC6677", linewidth=1.2, label="its estimate")
    a.set(xscale="log", yscale="log", xlabel="largest of a set (e²/h)", ylabel="sets")
    a.legend(loc="upper left")
    falling = np.sort(error.ravel())[::-1]
    b.step(falling, np.arange(1, falling.size + 1) / falling.size, where="pre", color="#4477AA")
    b.set(
        xscale="log", yscale="log", xlabel="x (e²/h)", ylabel="share of conductances with error > x"
    )
    b.set(xlim=(1e-9, end), ylim=(0.5 / falling.size, 1.5))
    bounds = ((CLOSE, 1 - SHARE_CLOSE, "at most"), (WORST, 0.1, "none"))
    for x, share, label in bounds:
        b.axvline(x, color="0.4", linestyle="--", linewidth=0.8)
        b.annotate(label, (x, share), (-3, 4), textcoords="offset points", ha="right")
    b.plot(CLOSE, 1 - SHARE_CLOSE, marker="v", color="0.2", markersize=5)
    for axes, letter in ((a, "a"), (b, "b")):
        axes.set_title(f"({letter})", loc="left")
    return figure


def save(measured: dict[str, FloatArray], path: Path) -> None:
    """Draw and write the picture."""
    with style.context(REPOSITORY / "paper_figures" / "style.mplstyle"):
        write_picture(path, draw(measured), dpi=200)
