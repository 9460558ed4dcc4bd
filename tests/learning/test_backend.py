"""What libraries write to standard error while Keras is imported."""

from __future__ import annotations

import os

import pytest

from disorder_landscape.learning.backend import _stderr_unless_it_fails


def failing():
    """Write, and fail."""
    with _stderr_unless_it_fails():
        os.write(2, b"what it says before it fails\n")
        raise ImportError


def test_notes_are_dropped_and_those_before_a_failure_are_shown(capfd):
    with _stderr_unless_it_fails():
        os.write(2, b"oneDNN custom operations are on\n")
    assert capfd.readouterr().err == ""
    with pytest.raises(ImportError):
        failing()
    os.write(2, b"afterwards\n")
    assert capfd.readouterr().err == "what it says before it fails\nafterwards\n"
