"""Several processes with one folder, or one file."""

import os
import subprocess
import sys
import time

import pytest

from disorder_landscape import ArgumentError
from disorder_landscape.files import replacing
from disorder_landscape.locks import kept_from_others

HOLD = (
    "import sys, time\n"
    "from pathlib import Path\n"
    "from disorder_landscape.locks import kept_from_others\n"
    "folder, name, shared, log = Path(sys.argv[1]), sys.argv[2], bool(sys.argv[3]), sys.argv[4]\n"
    "with kept_from_others(folder, name, shared):\n"
    "    for word in ('in', 'out'):\n"
    "        with open(log, 'a') as file:\n"
    "            file.write(word + ' ')\n"
    "        time.sleep(float(sys.argv[5]))\n"
)


def hold(folder, log, name="", shared=False, seconds=0.5):
    arguments = [str(folder), name, "yes" * shared, str(log), str(seconds)]
    return subprocess.Popen([sys.executable, "-c", HOLD, *arguments], stderr=subprocess.PIPE)


@pytest.mark.parametrize("name", ["", "result.nc"])
def test_one_works_after_the_other(tmp_path, name):
    log = tmp_path / "log"
    both = [hold(tmp_path / "folder", log, name) for _ in range(2)]
    said = b"".join(process.communicate()[1] for process in both)
    assert log.read_text() == "in out in out "
    assert said.count(b"waiting for another process that works on") == 1
    assert not list((tmp_path / "folder").iterdir())


def test_shares_work_side_by_side(tmp_path):
    log = tmp_path / "log"
    with kept_from_others(tmp_path, shared=True):
        assert hold(tmp_path, log, shared=True, seconds=0).communicate()[1] == b""
        alone = hold(tmp_path, log, seconds=0)
        while b"waiting" not in alone.stderr.readline():
            assert alone.poll() is None
        assert log.read_text() == "in out "
    alone.communicate()
    assert log.read_text() == "in out in out "


def test_a_killed_process_holds_nothing(tmp_path):
    log = tmp_path / "log"
    killed = hold(tmp_path, log, "result.nc", seconds=600)
    while not log.exists():
        time.sleep(0.02)
    killed.kill()
    killed.communicate()
    with kept_from_others(tmp_path, "result.nc"):
        pass
    assert [path.name for path in tmp_path.iterdir()] == ["log"]


def test_a_folder_that_cannot_be_made_is_an_error(tmp_path):
    (tmp_path / "file").write_text("")
    folder = tmp_path / "file" / "folder"
    must = "folder must be a place to write to"
    with pytest.raises(ArgumentError, match=must), kept_from_others(folder):
        pass


def test_what_is_being_written_is_each_process_own(tmp_path):
    """Of a running process it stays, of one that was killed it goes."""
    path = tmp_path / "table.csv"
    with replacing(path) as temporary:
        temporary.write_text("half")
        mine = temporary.name
        others = [mine.replace(f"-{os.getpid()}-", f"-{pid}-") for pid in (os.getppid(), 10**9)]
        for name in others:
            (tmp_path / name).write_text("other")
        (tmp_path / others[1]).unlink()
        (tmp_path / others[1]).mkdir()
    with replacing(path) as temporary:
        temporary.write_text("whole")
    assert {there.name for there in tmp_path.iterdir()} == {"table.csv", others[0]}
    assert path.read_text() == "whole"
