"""What several commands share: options, provenance, and how to go on after Ctrl-C."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from disorder_landscape.arguments import require

ConfigFile = Annotated[Path, typer.Option("--config", "-c", help="TOML file of the run.")]
Build = Annotated[Path, typer.Option(help="Folder of the results, one subfolder per run.")]
Workers = Annotated[int, typer.Option(min=1, max=1024, help="Processes, one thread each.")]
ShareOfTasks = Annotated[
    str, typer.Option("--share", help="Like 3/8: every eighth task only, from the third on.")
]


def refuse(context: typer.Context, names: Sequence[str], where: str) -> None:
    """Refuse options of a command where they would be without effect.

    Parameters
    ----------
    context : Context
        Of the command that runs.
    names : sequence of str
        Of its parameters; those that it does not have do not count.
    where : str
        Words like "with --list".

    Raises
    ------
    ArgumentError
        If one of them is given.
    """
    for name in names:
        source = context.get_parameter_source(name)
        is_given = source is not None and source.name != "DEFAULT"
        require(not is_given, name.replace("_", "-"), f"be left out {where}", "it is given")


@contextmanager
def resumable() -> Iterator[None]:
    """Tell whoever presses Ctrl-C how to go on."""
    try:
        yield
    except KeyboardInterrupt:
        print("\nlandscape: interrupted; the same command goes on from here", file=sys.stderr)
        raise typer.Exit(130) from None


def made_here() -> dict[str, str]:
    """Return the provenance of what this command line makes."""
    from disorder_landscape.dataset.store import provenance

    command = " ".join(["landscape", *sys.argv[1:]])
    return provenance(command.encode("utf-8", "backslashreplace").decode())  # names may be bytes


def check_outputs(
    output: Path,
    plot: Path | None = None,
    read: Sequence[Path] = (),
    others: Sequence[str] = (),
) -> None:
    """Raise an ArgumentError where a command could not write its netCDF file, or its picture.

    Or where its file is one of those that it reads. A picture may have other endings, too.
    """
    from disorder_landscape.files import check_netcdf
    from disorder_landscape.pictures import check_picture

    check_netcdf("output", output)
    same = output.resolve() in {path.resolve() for path in read}
    require(not same, "output", "be another file than those that are read", f"it is '{output}'")
    if plot is not None:
        check_picture("plot", plot, others)


def wrote(output: Path, plot: Path | None = None) -> str:
    """Return the words for what a command has written."""
    return f"wrote {output}" + (f" and {plot}" if plot else "")
