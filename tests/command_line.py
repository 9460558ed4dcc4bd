"""The command line, called in this process."""

import sys
from functools import cache

import pytest
import typer.main

from disorder_landscape.cli import main

known = cache(typer.main.get_command)
"""The tree of commands, which Typer makes anew for each call: half of a short command's time."""


def landscape(monkeypatch, capsys, *arguments):
    """Return exit code, standard output and standard error of a command."""
    monkeypatch.setattr(typer.main, "get_command", known)
    monkeypatch.setattr(sys, "argv", ["landscape", *map(str, arguments)])
    with pytest.raises(SystemExit) as stop:
        main()
    said = capsys.readouterr()
    return stop.value.code, said.out, said.err
