"""`landscape bench`: the solvers' times."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from disorder_landscape.parts import needs


@needs("figures")
def bench(
    repeats: Annotated[int, typer.Option(min=1, help="Measurements, of which the median.")] = 5,
    output: Annotated[Path, typer.Option(help="Folder of the table and the plot.")] = Path(
        "build/bench"
    ),
) -> None:
    """Time the fast solver against Kwant at its best, in one run of a few minutes.

    Example: landscape bench --repeats 5 --output build/bench
    """
    from tqdm import tqdm

    from disorder_landscape.bench.report import report

    with tqdm(total=repeats + 1, unit=" turns", desc="bench") as bar:
        lines = report(repeats, output, bar.update)
    print("\n".join([*lines, f"wrote {output}/bench.txt, bench.json and bench.png"]))
