"""The paper's claims: measure again what is quick, check the rest against stored results, print.

Each quick measurement must agree with its stored value within the spread that claims.toml allows
between runs; the exit status is 1 if one does not. That a value of ours differs from the paper's is
a verdict, no failure. Writes claims.json and claims.md.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from tqdm import tqdm

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.claims.claim import Claim, claim_of, load_claims
from disorder_landscape.claims.findings import Finding, stored_findings, with_measured
from disorder_landscape.claims.pages import PAGES, write_pages
from disorder_landscape.claims.sources import store
from disorder_landscape.claims.table import (
    COLUMNS,
    accepted,
    as_json,
    markdown,
    measured_by,
    number,
    ours,
    rows,
    stated,
    tally,
    verdict,
)
from disorder_landscape.files import check_writable, replacing, write_json
from disorder_landscape.machine import cores, cpu_name
from disorder_landscape.runs import REPOSITORY

VERSIONS = ("disorder-landscape", "numpy", "scipy", "keras", "kwant")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line; exit with 1 for a disagreement, 2 for what cannot be used."""
    options = _parse(arguments)
    try:
        if options.write_pages:
            changed = write_pages()
            for page in PAGES:
                print(f"{page}: " + ("written" if page in changed else "is as it should be"))
            return
        claims = load_claims()
        chosen = tuple(claim_of(name, claims) for name in options.only) or claims
        check_writable("output", options.output / "claims.json")
        found = stored_findings(chosen)
        measured = {} if options.stored else _measure(found)
        if options.store:
            store(measured)
            found = stored_findings(chosen)
        found = with_measured(found, {name: of["value"] for name, of in measured.items()})
        _write(found, options.output)
    except ArgumentError as error:
        print(f"claims: {error}", file=sys.stderr)
        sys.exit(2)
    _print(found, {name: of["minutes"] for name, of in measured.items()})
    disagreements = [one.disagreement for one in found if one.disagreement]
    for disagreement in disagreements:
        print(f"claims: {disagreement}", file=sys.stderr)
    sys.exit(1 if disagreements else 0)


def _measure(found: Sequence[Finding]) -> dict[str, dict[str, Any]]:
    """Return value, minutes, machine and versions of each quick measurement, by id."""
    from disorder_landscape.claims.measurements import measure

    made_by = {
        "machine": f"{cpu_name()}, {cores()} cores",
        **{f"version_{name}": version(name) for name in VERSIONS},
    }
    quick = [one.claim for one in found if one.claim.measured is not None and _can(one.claim)]
    measured = {}
    for claim in (bar := tqdm(quick, desc="measure", unit=" claims")):
        assert claim.measured is not None
        bar.set_postfix_str(claim.id)
        started = time.perf_counter()
        value = measure(claim.measured)
        minutes = (time.perf_counter() - started) / 60
        command = f"make claims ONLY={claim.id} STORE=1"
        measured[claim.id] = {"value": value, "minutes": minutes, "command": command, **made_by}
    return measured


def _can(claim: Claim) -> bool:
    """Return whether there is what a quick measurement needs."""
    source = claim.measured
    return source is not None and (source.needs is None or (REPOSITORY / source.needs).exists())


def _write(found: Sequence[Finding], folder: Path) -> None:
    write_json(folder / "claims.json", {"claims": as_json(found), "tally": tally(found)})
    columns, table = (*COLUMNS, "now"), rows(found)
    again = ["" if one.again is None else number(one.again) for one in found]
    text = markdown(columns, [(*row, now) for row, now in zip(table, again, strict=True)])
    with replacing(folder / "claims.md") as temporary:
        temporary.write_text(f"{tally(found)}\n\n{text}", "utf-8")


def _print(found: Sequence[Finding], minutes: dict[str, float]) -> None:
    """Print the table, a few lines for each claim: it is too wide for one."""
    for one in found:
        claim = one.claim
        print(f"{claim.id}  {claim.statement} ({claim.where})")
        lines = {
            "paper": f"{stated(claim)}   accepted: {accepted(claim)}" if stated(claim) else "",
            "ours": ours(one, "\n" + " " * 14),
            "now": "" if one.again is None else f"{number(one.again)}, {minutes[claim.id]:.2f} min",
            "verdict": verdict(one),
            "by": measured_by(one).replace("`", ""),
        }
        for name, line in lines.items():
            if line:
                print(f"    {name:10}{line}")
    print(f"\n{len(found)} claims: {tally(found)}")


def _parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m disorder_landscape.claims",
        description=__doc__,
        epilog="example: python -m disorder_landscape.claims --only components-54 --only r2-five\n"
        "measures two of them again, in half a minute, and prints the paper's value and ours",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--only", action="append", default=[], metavar="ID", help="this claim; may be repeated"
    )
    parser.add_argument(
        "--stored", action="store_true", help="measure nothing, only check what is stored"
    )
    parser.add_argument(
        "--store",
        action="store_true",
        help="keep what has been measured in results/measured.json, as the stored values",
    )
    parser.add_argument(
        "--write-pages",
        action="store_true",
        help="write the tables of README.md and docs from what is stored, and do nothing else",
    )
    parser.add_argument(
        "--output",
        type=Path,
        default=Path("build"),
        metavar="FOLDER",
        help="where to write claims.json and claims.md (default: %(default)s)",
    )
    return parser.parse_args(arguments)


if __name__ == "__main__":
    main()
