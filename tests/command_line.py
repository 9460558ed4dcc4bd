"""The command line, called in this process."""

import sys

import pytest

from disorder_landscape.cli import main


def landscape(monkeypatch, capsys, *arguments):
    """Return exit code, standard output and standard error of a command."""
    monkeypatch.setattr(sys, "argv", ["landscape", *map(str, arguments)])
    with pytest.raises(SystemExit) as stop:
        main()
    said = capsys.readouterr()
    return stop.value.code, said.out, said.err
