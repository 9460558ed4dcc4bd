"""How accurate conductances at finite temperature are, against the integral done by brute force.

Random wires (pristine, of 5, 10 and 30 components, weak and strong, of uncorrelated noise), each at
a random μ, B, temperature and five biases. What `conductance` and `generate` compute is compared
with ∫ dω G₀(ω) (−f'(ω − V)) by adaptive quadrature (`solver.quadrature`), which assumes nothing
about G₀; that this has converged is shown by a finer run of some of the wires.

Writes accuracy.txt, accuracy.json and accuracy.png. Interrupted, it goes on where it stopped.
"""

from __future__ import annotations

import argparse
import hashlib
import inspect
import signal
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib import style
from matplotlib.figure import Figure
from threadpoolctl import threadpool_limits
from tqdm import tqdm

from disorder_landscape import Nanowire
from disorder_landscape.arguments import ArgumentError, require
from disorder_landscape.chain import REPOSITORY
from disorder_landscape.dataset.store import provenance
from disorder_landscape.files import check_writable, replacing, write_json
from disorder_landscape.model.disorder import disorder_realization
from disorder_landscape.model.parameters import B_MAX, BOLTZMANN, MU_MAX, SITES, FloatArray
from disorder_landscape.solver.compiled import core
from disorder_landscape.solver.quadrature import REACH, thermal_quadrature
from disorder_landscape.solver.routes import thermal_average

SEED = 20
KINDS = ("pristine", "5 weak", "5 strong", "10 weak", "10 strong", "30 weak", "30 strong", "noise")
"""Kinds of wires: components, weak or strong amplitude ("sum", "double"); uncorrelated noise."""
TEMPERATURES = (0.02, 0.05, 0.06)
"""In K."""
BIASES = 5
BIAS_MAX = 0.05
"""In meV."""
BRUTE = {"panel": 0.05, "tolerance": 1e-8}
FINER = {"panel": 0.02, "tolerance": 1e-9}
BELOW_GAP = 0.99
"""Part of the gap at which the brute-force integral ends; the finer one goes on across the gap."""
FINER_EVERY = 51
"""Every so many wires is integrated more finely too: 40 of 2000, at B = 0 every tenth of them."""
WIRES_OF_CHUNK = 25

CLOSE, WORST = 1e-4, 1e-3
"""Errors in e²/h: of nearly all conductances, and of every one."""
SHARE_CLOSE = 0.999
"""Share of conductances that must be within CLOSE."""
QUANTILES = (0.5, 0.9, 0.99, 0.999, 1.0)


class Case(NamedTuple):
    """One wire, and where it is measured."""

    kind: int
    wire: Nanowire
    mu: FloatArray
    B: FloatArray
    bias: FloatArray
    temperature: float


def random_case(index: int, sites: int = SITES) -> Case:
    """Draw the case of an index; every tenth is at B = 0."""
    rng = np.random.default_rng([SEED, index])
    family, amplitude = rng.integers(5), rng.integers(2)
    if family == 0:
        kind, V = 0, np.zeros(sites)
    elif family == 4:
        kind, V = 7, rng.normal(0.0, rng.uniform(0.1, 2.0), sites)
    else:
        kind, components = 2 * family - 1 + amplitude, (5, 10, 30)[family - 1]
        strength = ("sum", "double")[amplitude]
        V = disorder_realization(rng, components, sites, amplitude=strength)[1]
    return Case(
        kind=int(kind),
        wire=Nanowire(V, alpha=rng.uniform(6.4, 9.6)),
        mu=np.array([rng.uniform(0.0, MU_MAX)]),
        B=np.array([rng.uniform(0.0, B_MAX) if index % 10 else 0.0]),
        bias=np.sort(rng.uniform(-BIAS_MAX, BIAS_MAX, BIASES)),
        temperature=float(rng.choice(TEMPERATURES)),
    )


def measure(case: Case, finer: bool) -> dict[str, Any]:
    """Return what is kept of one wire, in e²/h.

    Returns
    -------
    dict
        kind; error, shape (bias, 4): |exact − brute|; estimate and energies of the exact average;
        brute, the brute-force integral's own estimate; if `finer`, converged: its largest
        difference from the finer one, and finest, that one's estimate, else NaN.
    """
    _, wire, mu, B, bias, temperature = case
    G, estimate, energies = thermal_average([wire], mu, B, bias, temperature)
    below = BELOW_GAP * (wire.delta0 - abs(bias).max()) / (BOLTZMANN * temperature)
    brute = thermal_quadrature([wire], mu, B, bias, temperature, reach=min(REACH, below), **BRUTE)
    converged = finest = np.nan
    if finer:
        best = thermal_quadrature([wire], mu, B, bias, temperature, **FINER)
        converged = abs(brute.conductance - best.conductance).max()
        finest = best.error.item()
    return {
        "kind": case.kind,
        "error": abs(G - brute.conductance)[0, 0, 0],
        "estimate": estimate.item(),
        "energies": energies.item(),
        "brute": brute.error.item(),
        "converged": converged,
        "finest": finest,
    }


def study(wires: int, workers: int, folder: Path) -> dict[str, FloatArray]:
    """Measure so many wires and return the arrays of `measure`, with a leading dim wire.

    Chunks that the folder holds already are read; the others are made and kept there.
    """
    folder = folder / _fingerprint()
    chunks = range(-(-wires // WIRES_OF_CHUNK))
    missing = [k for k in chunks if not _chunk_path(folder, k).exists()]
    with (
        tqdm(
            total=len(chunks) * WIRES_OF_CHUNK,
            initial=(len(chunks) - len(missing)) * WIRES_OF_CHUNK,
            unit=" wires",
            desc="accuracy",
            smoothing=0.1,
        ) as bar,
        ProcessPoolExecutor(workers, get_context("spawn"), _start_worker) as pool,
    ):
        futures = [pool.submit(_make_chunk, folder, k) for k in missing]
        try:
            for future in as_completed(futures):
                bar.update(future.result())
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    parts = [_read_chunk(_chunk_path(folder, k)) for k in chunks]
    return {name: np.concatenate([part[name] for part in parts])[:wires] for name in parts[0]}


def _fingerprint() -> str:
    """Return a name for the results of these very solvers and cases, so that no others are read."""
    root = Path(__file__).parents[1]
    package = root / "src" / "disorder_landscape"
    paths = [path for room in ("model", "solver") for path in package.glob(f"{room}/*.py")]
    paths += root.glob("core/**/*.hpp")
    text = [path.read_bytes() for path in sorted(paths)]
    text += [inspect.getsource(function).encode() for function in (random_case, measure)]
    text.append(repr([SEED, TEMPERATURES, BIASES, BIAS_MAX, BRUTE, FINER, BELOW_GAP]).encode())
    text.append(repr([FINER_EVERY, WIRES_OF_CHUNK]).encode())
    return hashlib.sha256(b"\n".join(text)).hexdigest()[:12]


def _chunk_path(folder: Path, chunk: int) -> Path:
    return folder / f"chunk-{chunk:04d}.npz"


def _make_chunk(folder: Path, chunk: int) -> int:
    """Measure and write one chunk; return how many wires it holds."""
    indices = range(chunk * WIRES_OF_CHUNK, (chunk + 1) * WIRES_OF_CHUNK)
    rows = [measure(random_case(i), finer=i % FINER_EVERY == 0) for i in indices]
    with replacing(_chunk_path(folder, chunk)) as temporary:
        np.savez(temporary, **{name: np.array([row[name] for row in rows]) for name in rows[0]})
    return len(rows)


def _read_chunk(path: Path) -> dict[str, FloatArray]:
    with np.load(path) as chunk:
        return dict(chunk)


def _start_worker() -> None:
    """Keep a worker to one thread, and leave Ctrl-C to the process that waits for it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    core.set_threads(1)
    threadpool_limits(1)


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
    checks = core.COMPARED
    most = sum(nodes + checks for nodes in core.NODES)
    rational = energies <= most
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
            str(number): int(count) for number, count in zip(numbers, sets, strict=True)
        },
        "sets_with_quadrature": int(np.sum(~rational)),
    }


def _quantiles(values: FloatArray) -> dict[str, float]:
    return {f"{q:g}": float(np.quantile(values, q)) for q in QUANTILES}


def report(numbers: dict[str, Any], made_with: dict[str, str]) -> str:
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
        "",
        *(f"{name}: {value}" for name, value in made_with.items()),
    ]
    return "\n".join(lines) + "\n"


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


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the study; exit with 1 if a bound fails, with 2 for arguments that cannot be used."""
    options = _parse(arguments)
    try:
        require(options.wires > 0, "wires", "be positive", f"it is {options.wires}")
        require(options.workers > 0, "workers", "be positive", f"it is {options.workers}")
        check_writable("output", options.output / "accuracy.txt")
        measured = study(options.wires, options.workers, options.build)
        numbers = summary(measured)
        made_with = provenance(f"python results/accuracy.py --wires {options.wires}")
        made_with["seed"] = str(SEED)
        text = report(numbers, made_with)
        with replacing(options.output / "accuracy.txt") as temporary:
            temporary.write_text(text, "utf-8")
        write_json(options.output / "accuracy.json", {**numbers, "provenance": made_with})
        with (
            style.context(REPOSITORY / "paper_figures" / "style.mplstyle"),
            replacing(options.output / "accuracy.png") as temporary,
        ):
            draw(measured).savefig(temporary, dpi=200)
    except ArgumentError as error:
        print(f"accuracy.py: {error}", file=sys.stderr)
        sys.exit(2)
    print(text, end="")
    sys.exit(0 if numbers["passed"] else 1)


def _parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="accuracy.py",
        description=__doc__,
        epilog="example: python results/accuracy.py --wires 100 --output build/accuracy\n"
        "takes some seconds and says whether the bounds hold; its exit status is 1 if one fails",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--wires", type=int, default=2000, help="default: %(default)s")
    parser.add_argument(
        "--workers",
        type=int,
        default=2,
        help="processes of one thread each (default: %(default)s)",
    )
    parser.add_argument(
        "--output",
        type=Path,
        default=Path(__file__).parent,
        metavar="FOLDER",
        help="where to write accuracy.txt, .json and .png (default: the script's folder)",
    )
    parser.add_argument(
        "--build",
        type=Path,
        default=Path("build/accuracy"),
        metavar="FOLDER",
        help="where chunks of the results are kept (default: %(default)s)",
    )
    return parser.parse_args(arguments)


if __name__ == "__main__":
    main()
