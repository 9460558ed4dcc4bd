"""How right the solver is for odd wires: over the whole range that each parameter is accepted in.

At T = 0 the conductances of one random wire, μ, B, angle and energy after the other are compared
with those of Kwant; where they do not agree to 1e-6 e²/h, numbers of 600 bits tell who is right
(`exact.py`). Where Kwant's own conductance changes as much when μ does by some roundings of 2t, no
solver can know it, and a wire is not counted. At T > 0 the
average in closed form is compared with the integral by adaptive quadrature, and its estimated error
with the true one.

Interrupted, it goes on where it stopped.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from exact import exact_conductances
from tqdm import tqdm

from disorder_landscape import Nanowire
from disorder_landscape.arguments import ArgumentError, require
from disorder_landscape.model.parameters import BOLTZMANN, PARAMETER_RANGES, FloatArray
from disorder_landscape.solver import compiled, kwant_reference
from disorder_landscape.solver.quadrature import thermal_quadrature
from disorder_landscape.solver.routes import BELOW_GAP, closed_form

CLOSE = 1e-6
"""Difference in e²/h that is allowed."""
KNOWN = CLOSE / 10
"""How far Kwant's conductance must be known to count."""
ROUNDINGS = 16
"""By so many roundings of 2t μ is moved to see whether the conductance can be known."""
FACTOR, SMALLEST = 3.0, 1e-5
"""An error beyond SMALLEST (e²/h) must not be larger than so many times its estimate."""
SHARE_BEYOND = 1e-3
"""Of the accepted averages at most this part may be."""
SHOWN = 10
"""Worst cases that are printed."""


class Case(NamedTuple):
    """A wire and where it is measured."""

    wire: Nanowire
    mu: FloatArray
    B: FloatArray
    theta: float


def _scale(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw a number whose logarithm is uniform."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _potential(rng: np.random.Generator, largest: float) -> FloatArray:
    """Draw a potential: none, noise, a step, or a few bumps."""
    many = rng.integers(100, 301) if rng.random() < 0.1 else rng.integers(2, 100)
    V = np.zeros(int(many))
    height = _scale(rng, 1e-3, largest) * rng.choice([-1, 1])
    kind = rng.integers(4)
    if kind == 1:
        V = np.clip(rng.normal(0.0, abs(height) / 3, V.size), -1e3, 1e3)
    elif kind == 2:
        V[rng.integers(V.size) :] = height
    elif kind == 3:
        V[rng.integers(0, V.size, 3)] = height
    return V


def any_case(seed: int, index: int) -> Case:
    """Draw a wire over the whole range of every parameter; half of all values are the paper's."""
    rng = np.random.default_rng([seed, 0, index])
    chosen: dict[str, Any] = {}
    for name, (low, high, _) in PARAMETER_RANGES.items():
        kind = rng.integers(6)
        if name == "dissipation" and kind < 5:
            continue
        if kind == 0:
            chosen[name] = _scale(rng, max(low, 1e-6 * high), high)
            if low < 0 and rng.random() < 0.3:
                chosen[name] *= -1
        elif kind == 1:
            chosen[name] = float(rng.uniform(low, high))
        elif kind == 2 and name not in ("mass", "lattice", "delta0"):
            chosen[name] = max(low, 0.0)
    barrier = tuple(rng.choice([0.0, 15.0, rng.uniform(-1e3, 1e3)], 2))
    wire = Nanowire(_potential(rng, 1e3), barrier=barrier, **chosen)
    mu = rng.choice([0.0, rng.uniform(0, 0.6), rng.uniform(-5, 50), rng.uniform(-1e3, 1e3)])
    B = rng.choice([0.0, rng.uniform(0, 0.8), _scale(rng, 1e-17, 100), -rng.uniform(0, 1)])
    theta = rng.choice([0.0, 0.0, np.pi / 2, rng.uniform(-6, 6)])
    return Case(wire, np.array([mu]), np.array([B]), float(theta))


def compare_with_kwant(seed: int, index: int) -> dict[str, Any]:
    """Return the largest difference of the conductances, and how far Kwant's can be known."""
    case, rng = any_case(seed, index), np.random.default_rng([seed, 1, index])
    wire, mu, B, theta = case
    above = rng.random() < 0.2
    share = 1 + _scale(rng, 1e-3, 2) if above else rng.choice([0.0, 1e-9, rng.uniform(0, 1)])
    omega = np.array([share * wire.delta0])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of Kwant, on its eigenvectors
        try:
            move = ROUNDINGS * np.finfo(np.float64).eps * (2 * wire.hopping + abs(mu))
            exact, moved = (
                kwant_reference.bare_conductance([wire], at, B, omega, theta)
                for at in (mu, mu + move)
            )
        except Exception as error:  # LAPACK, or modes that Kwant cannot tell apart
            return {"index": index, "failed": f"{type(error).__name__}: {error}"}
    found = compiled.bare_conductance([wire], mu, B, omega, theta)
    row = {
        "index": index,
        "error": _largest(found - exact),
        "unknown": _largest(moved - exact),
        "omega": float(omega[0]),
    }
    if row["error"] > CLOSE and row["unknown"] <= KNOWN:
        true = exact_conductances(wire, mu[0], B[0], omega[0], theta)
        row |= {"true error": _largest(found - true), "of Kwant": _largest(exact - true)}
    return row


def warm_case(seed: int, index: int) -> tuple[Case, FloatArray, float]:
    """Draw a wire of parameters within some orders of the paper's, biases and a temperature."""
    rng = np.random.default_rng([seed, 2, index])
    sites = int(rng.choice([rng.integers(2, 100), 300, rng.integers(100, 700)]))
    V = _potential(rng, 3.0)
    wire = Nanowire(
        np.resize(V, sites),
        alpha=rng.choice([8.0, 2.0, rng.uniform(0, 40)]),
        g=rng.choice([25.0, rng.uniform(0, 60)]),
        gamma=rng.choice([0.15, 0.5, rng.uniform(0, 1)]),
        delta0=rng.choice([0.12, rng.uniform(0.1, 0.5)]),
        mass=rng.choice([0.03, _scale(rng, 0.01, 0.3)]),
        barrier=tuple(rng.choice([0.0, 15.0, rng.uniform(0, 300)], 2)),
        lead_mu=rng.choice([25.0, rng.uniform(0.5, 60)]),
        lead_alpha=rng.choice([None, 0.0, rng.uniform(0, 30)]),
    )
    temperature = float(rng.choice([0.02, 0.05, 0.06]))
    most = BELOW_GAP * wire.delta0 - compiled.core.REACH * BOLTZMANN * temperature
    bias = np.sort(rng.uniform(-most, most, 3))
    theta = float(rng.choice([0.0, 0.0, 0.0, 0.0, rng.uniform(-3, 3)]))
    mu, B = np.array([rng.uniform(0, 0.6)]), np.array([rng.uniform(0, 1) * (rng.random() < 0.95)])
    return Case(wire, mu, B, theta), bias, temperature


def compare_with_quadrature(seed: int, index: int) -> dict[str, Any]:
    """Return the largest error of the average in closed form and its estimate; NaN if rejected."""
    (wire, mu, B, theta), bias, temperature = warm_case(seed, index)
    arguments = [wire], mu, B, bias, temperature
    G, estimate, _ = closed_form(*arguments, theta)
    if not estimate.item() <= compiled.core.TOLERANCE:
        return {"index": index, "error": None}
    exact = thermal_quadrature(*arguments, theta=theta)
    error = _largest(G - exact.conductance)
    return {
        "index": index,
        "error": error,
        "estimate": estimate.item(),
        "integral": exact.error.item(),
    }


def _largest(difference: FloatArray) -> float:
    """Return the largest absolute value, infinity for NaN, which JSON does not know."""
    largest = float(abs(difference).max())
    return largest if np.isfinite(largest) else 1e300


def _study(
    compare: Callable[[int, int], dict[str, Any]], seed: int, count: int, folder: Path
) -> list[dict[str, Any]]:
    """Return the rows of so many cases; those that the folder holds are read."""
    path = folder / f"{compare.__name__}-{seed}-{_fingerprint()}.jsonl"
    path.parent.mkdir(parents=True, exist_ok=True)
    lines = path.read_text("utf-8").splitlines(keepends=True) if path.exists() else []
    rows = [json.loads(line) for line in lines if line.endswith("\n")]
    path.write_text("".join(line for line in lines if line.endswith("\n")), "utf-8")
    with path.open("a", encoding="utf-8") as file:
        for index in tqdm(range(len(rows), count), compare.__name__, count, initial=len(rows)):
            rows.append(compare(seed, index))
            file.write(json.dumps(rows[-1]) + "\n")
            file.flush()
    return rows[:count]


def _fingerprint() -> str:
    """Return a name for the results of these very solvers and cases."""
    root = Path(__file__).parents[1]
    package = root / "src" / "disorder_landscape"
    paths = [path for room in ("physics", "solver") for path in package.glob(f"{room}/*.py")]
    paths += root.glob("core/**/*.hpp")
    return hashlib.sha256(
        b"\n".join(path.read_bytes() for path in [*sorted(paths), Path(__file__)])
    ).hexdigest()[:12]


def report(cold: list[dict[str, Any]], warm: list[dict[str, Any]]) -> tuple[str, bool]:
    """Return the report, and whether both bounds hold."""
    known = [row for row in cold if "error" in row and row["unknown"] <= KNOWN]
    apart = [row for row in known if row["error"] > CLOSE]
    wrong = [row for row in apart if row["true error"] > CLOSE]
    accepted = [row for row in warm if row["error"] is not None]
    beyond = [
        row
        for row in accepted
        if row["error"] > SMALLEST and row["error"] > FACTOR * row["estimate"] + row["integral"]
    ]
    lines = [
        f"T = 0, against Kwant: {len(cold)} wires; Kwant failed at "
        f"{sum('failed' in row for row in cold)}, {len(known)} can be known to {KNOWN:g}, "
        f"{len(apart)} of them differ by more than {CLOSE:g} e²/h; the solver is off by as much in "
        f"{len(wrong)}",
        *(str(row) for row in sorted(wrong, key=lambda row: -row["error"])[:SHOWN]),
        f"T > 0, against quadrature: {len(warm)} sets, {len(accepted)} accepted, of {len(beyond)} "
        f"the error is beyond {SMALLEST:g} e²/h and {FACTOR:g} times the estimate; largest "
        f"{max((row['error'] for row in accepted), default=0.0):.1e}",
        *(str(row) for row in sorted(beyond, key=lambda row: -row["error"])[:SHOWN]),
    ]
    return "\n".join(lines), not wrong and len(beyond) <= SHARE_BEYOND * len(accepted)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the search; exit with 1 if it finds too much, with 2 for arguments that do not do."""
    parser = argparse.ArgumentParser(
        prog="odd_wires.py",
        description=__doc__,
        epilog="example: python results/odd_wires.py --count 100 --warm 30",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--count", type=int, default=3000, help="wires at T = 0 (%(default)s)")
    parser.add_argument("--warm", type=int, default=1000, help="sets at T > 0 (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="another search (%(default)s)")
    parser.add_argument("--build", type=Path, default=Path("build/odd_wires"), metavar="FOLDER")
    options = parser.parse_args(arguments)
    try:
        for name in ("count", "warm", "seed"):
            value = getattr(options, name)
            require(value >= 0, name, "not be negative", f"it is {value}")
    except ArgumentError as error:
        print(f"odd_wires.py: {error}", file=sys.stderr)
        sys.exit(2)
    cold = _study(compare_with_kwant, options.seed, options.count, options.build)
    warm = _study(compare_with_quadrature, options.seed, options.warm, options.build)
    text, passed = report(cold, warm)
    print(text)
    sys.exit(0 if passed else 1)


if __name__ == "__main__":
    main()
