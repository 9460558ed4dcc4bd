"""The benchmark's table, and its files."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from disorder_landscape.bench.measurements import DATASETS, PAPER_ENERGIES, Progress, measure
from disorder_landscape.bench.plot import plot
from disorder_landscape.bench.stopwatches import BIASES
from disorder_landscape.files import check_writable, replacing, write_json
from disorder_landscape.model.parameters import SITES, TEMPERATURE


def report(repeats: int, folder: Path, progress: Progress = lambda done: None) -> list[str]:
    """Measure everything, write bench.json, bench.txt and bench.png; return the lines of the table.

    Parameters
    ----------
    repeats : int
        Turns, of which the medians are taken.
    folder : Path
        Where the files go.
    progress : callable
        Called after each turn.

    Raises
    ------
    ArgumentError
        If the folder cannot be written, before anything is measured.
    """
    check_writable("output", folder / "bench.txt")
    found = measure(repeats, progress)
    lines = list(table(found))
    write_json(folder / "bench.json", found)
    with replacing(folder / "bench.txt") as temporary:
        temporary.write_text("\n".join(lines) + "\n", "utf-8")
    plot(found, folder / "bench.png")
    return lines


def table(found: dict[str, Any]) -> Iterator[str]:
    """Yield the lines of the table of what `measure` returns."""
    times, ratio, hours = found["medians"], found["Kwant / fast"], found["core-hours"]

    def line(what: str, value: float, unit: str, digits: int = 1) -> str:
        return f"{what:54s}{value:12,.{digits}f} {unit}".rstrip()

    yield f"{SITES} sites, {found['machine']['cpu']}, medians of {found['repeats']}, one thread"
    yield line("Kwant, per energy", 1e3 * times["Kwant, per energy"], "ms", 3)
    yield line("fast, per energy", 1e6 * times["per energy"], "us", 3)
    yield line("Kwant / fast, per energy", ratio["per energy"], "", 0)
    yield ""
    yield f"sets of one mu and B, {BIASES.size} biases at {1e3 * TEMPERATURE:g} mK"
    kwant = f"Kwant, {PAPER_ENERGIES} energies"
    yield line(kwant, 1e3 * PAPER_ENERGIES * times["Kwant, per energy"], "ms")
    grid = f"fast, energy grid, {found['grid energies']} energies"
    yield line(grid, 1e6 * times["per set, energy grid"], "us")
    for name, of in found["sets"].items():
        yield line(f"exact, {name}", 1e6 * times[f"per set, {name}"], "us")
        yield line(f"Kwant / exact, {name}", ratio[f"per set, {name}"], "", 0)
        yield line(f"energies in the mean, {name}", of["energies"], "")
        yield line(f"largest estimated error, {name}", 1e6 * of["largest error"], "1e-6 e2/h")
    yield line(f"speed-up of {found['threads']} threads", found["speed-up"], "", 2)
    yield ""
    yield f"{'core-hours of the two datasets':38s}{'exact':>10s}{'Kwant':>10s}{'paper':>10s}"
    for name, config in DATASETS.items():
        what = f"{config.realizations} x {config.mu_points}x{config.B_points}, {name}"
        of = hours[name]
        yield f"{what:38s}{of['fast']:10,.2f}{of['Kwant']:10,.0f}{of['paper']:10,.0f}"
    yield ""
    yield f"{'sites':20s}" + "".join(f"{n:15d}" for n in found["sites"]) + "    exponent, 2 longest"
    for name in ("per energy", "per set"):
        of = [1e6 * times[f"{name}, {n} sites"] for n in found["sites"]]
        slope = found["exponent"][name]
        values = "".join(f"{value:15,.2f}" for value in of)
        yield f"{name + ' (us)':20s}{values}{slope['all']:12.2f}{slope['longest']:11.2f}"
    yield f"{'energies per set':20s}" + "".join(f"{n:15,.1f}" for n in found["energies per set"])
    yield ""
    what = "gradient, per bias, dataset grid"
    yield line(what, 1e6 * times[what], "us", 3)
    yield line("gradient, per bias", 1e6 * times["gradient, per bias"], "us", 3)
    what = "per energy, gradient grid"
    yield line(what, 1e6 * times[what], "us", 3)
    yield line("gradient / conductance", found["gradient / conductance"], "", 2)
    yield ""
    yield f"one mu and B as a multiple of a set at {1e3 * TEMPERATURE:g} mK"
    for name, times_as_long in found["beyond / per set"].items():
        yield line(name, times_as_long, "", 2)
    for realizations, peak in found["peak MiB"].items():
        yield line(f"peak memory, {realizations} realizations", peak, "MiB")
