"""A disk without space, a folder that cannot be: one sentence, and nothing half written."""

import os
import resource
import signal
from contextlib import contextmanager

import numpy as np
import pytest

from disorder_landscape import ArgumentError, Nanowire, conductance
from disorder_landscape.learning.curves import Epoch, plot_curves, write_curves
from disorder_landscape.simulation import plot_simulation
from kinds_of_files import KINDS

EPOCHS = [Epoch(1, 1, 1e-4, 0.5, 0.5, 1.0), Epoch(2, 1, 1e-4, 0.4, 0.6, 1.0)]
SHOWN = conductance(Nanowire(np.zeros(20)), [0.1, 0.2], [0.0, 0.5], [0.0, 0.02])

WRITTEN = {
    **{
        name: KINDS[name].make
        for name in ("shard", "measurement", "table", "unfinished inversion", "training")
    },
    "curves": lambda folder: write_curves(folder / "curves.csv", EPOCHS),
    "picture of curves": lambda folder: plot_curves(folder / "curves.pdf", EPOCHS),
    "picture of conductances": lambda folder: plot_simulation(SHOWN, folder / "wire.png"),
}


@contextmanager
def space_for(size):
    """Let no file of this process grow beyond so many bytes, as on a full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        signal.signal(signal.SIGXFSZ, before)


def content(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("size", [8, 2000])
@pytest.mark.parametrize("kind", WRITTEN)
def test_a_full_disk_leaves_nothing_half_written(kind, size, tmp_path):
    whole = tmp_path / "whole"
    whole.mkdir()
    WRITTEN[kind](whole)
    needed = max(len(text) for text in content(whole).values())
    folder = tmp_path / "full"
    folder.mkdir()
    with space_for(size):
        if needed <= size:
            WRITTEN[kind](folder)
            return
        with pytest.raises(ArgumentError, match=r"cannot be written \(.+\)"):
            WRITTEN[kind](folder)
    assert {path.name for path in content(folder)} <= {path.name for path in content(whole)}
    assert all(len(text) <= size for text in content(folder).values())


@pytest.mark.parametrize("kind", ["measurement", "table", "picture of conductances"])
def test_a_full_disk_leaves_what_was_there(kind, tmp_path):
    WRITTEN[kind](tmp_path)
    before = content(tmp_path)
    with space_for(8), pytest.raises(ArgumentError, match="cannot be written"):
        WRITTEN[kind](tmp_path)
    assert content(tmp_path) == before


@pytest.mark.parametrize("kind", WRITTEN)
def test_where_no_folder_can_be_is_one_sentence(kind, tmp_path):
    (tmp_path / "thesis").write_text("Chapter 1")
    with pytest.raises(ArgumentError, match="cannot be written"):
        WRITTEN[kind](tmp_path / "thesis" / "results")
    assert content(tmp_path) == {tmp_path / "thesis": b"Chapter 1"}


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
@pytest.mark.parametrize("kind", WRITTEN)
def test_a_folder_without_permission_is_one_sentence(kind, tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(ArgumentError, match="cannot be written"):
        WRITTEN[kind](tmp_path)
    assert content(tmp_path) == {}
