"""A disorder potential from a file."""

from __future__ import annotations

import re
from pathlib import Path
from tokenize import TokenError

import numpy as np

from disorder_landscape.arguments import ArgumentError, require
from disorder_landscape.dataset.store import read_dataset
from disorder_landscape.model.parameters import MOST_SITES, FloatArray
from disorder_landscape.model.ranges import checked_potential

NOT_NUMBERS = (ValueError, EOFError, SyntaxError, TokenError, TypeError, OverflowError)
"""What NumPy raises for files that are damaged or something else."""
UNIT = re.compile(r"[(\[]\s*(\w*eV|\w?V)\s*[)\]]")
"""An energy or a voltage in brackets."""


def read_potential(path: Path) -> FloatArray:
    """Read V_dis(x) in meV from a file.

    Parameters
    ----------
    path : Path
        .npy (a vector), .nc (the variable potential), or text with one site per line, the potential
        in the last comma-separated column, with or without a header line: one that ends with no
        number, or begins with a comma, as those of pandas do. A unit in brackets in it must be meV.

    Raises
    ------
    ArgumentError
        If the file cannot be read as that, or holds NaN.
    """
    must = "be a .csv, .npy or .nc file of one potential value in meV per site"
    if path.suffix == ".nc":
        V = read_dataset(path, ["potential"])["potential"].to_numpy()
    else:
        try:
            V = _read_npy(path) if path.suffix == ".npy" else _read_text(path)
        except FileNotFoundError:
            raise ArgumentError("potential", must, f"there is no '{path}'") from None
        except (OSError, *NOT_NUMBERS) as error:
            reason = str(error).splitlines()[0]
            raise ArgumentError("potential", must, f"'{path}' is not: {reason}") from None
    V = checked_potential(V)
    few = V.size <= MOST_SITES
    require(few, "potential", f"have {MOST_SITES} sites at most", f"it has {V.size}")
    return V


def _read_npy(path: Path) -> FloatArray:
    with open(path, "rb") as file:  # NumPy leaves it open where the header is damaged
        return np.asarray(np.load(file, allow_pickle=False))


def _read_text(path: Path) -> FloatArray:
    lines = path.read_text("utf-8-sig").splitlines()
    last = {n: line.split(",")[-1].strip() for n, line in enumerate(lines, 1) if line.strip()}
    if lines and lines[0].startswith(","):  # the header of an index without a name
        _check_unit(last.pop(1))
    values = []
    for number, word in last.items():
        try:
            values.append(float(word))
        except ValueError:
            if number == min(last):  # the first line may be a header
                _check_unit(word)
            else:
                message = f"line {number} ends with '{word}', which is no number"
                raise ValueError(message) from None
    if len(values) < 2:
        raise ValueError("it holds fewer than two lines with a number, one for each site")
    return np.array(values)


def _check_unit(header: str) -> None:
    """Require that the unit which a column's header may state is meV."""
    stated = UNIT.search(header)
    if stated and stated[1] != "meV":
        raise ValueError(f"its header says {stated[1]}")
