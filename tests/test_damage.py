"""Files that were damaged: each is refused with a sentence, or says what it said; none is written.

Ten kinds of damage to each kind of file, once each in the fast tests and fifty times in the slow
ones.
"""

import h5py
import numpy as np
import pytest

from disorder_landscape import ArgumentError
from disorder_landscape.dataset import shards
from kinds_of_files import CONFIG, KINDS

DAMAGES = {
    "cut off": lambda b, rng: b[: rng.integers(len(b))],
    "empty": lambda b, rng: b"",
    "a bit": lambda b, rng: _changed(b, rng, lambda x: [x[0] ^ (1 << int(rng.integers(8)))], 1),
    "zeros": lambda b, rng: _changed(b, rng, lambda x: bytes(len(x)), 64),
    "noise": lambda b, rng: _changed(b, rng, lambda x: rng.bytes(len(x)), 64),
    "longer": lambda b, rng: b + rng.bytes(100),
    "swapped": lambda b, rng: b[len(b) // 2 :] + b[: len(b) // 2],
    "foreign": lambda b, rng: b"%PDF-1.4 " + rng.bytes(1000),
    "inserted": lambda b, rng: _changed(b, rng, lambda x: b"x" + x, 1),
    "lost": lambda b, rng: _changed(b, rng, lambda x: b"", 1),
}


def _changed(content, rng, change, length):
    at = int(rng.integers(max(len(content) - length, 1)))
    return content[:at] + bytes(change(content[at : at + length])) + content[at + length :]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Return a folder with a file of a kind, and what it says."""
    known = {}

    def make(kind):
        if kind not in known:
            folder = tmp_path_factory.mktemp("made")
            KINDS[kind].make(folder)
            known[kind] = folder, KINDS[kind].read(folder)
        return known[kind]

    return make


@pytest.mark.parametrize("times", [1, pytest.param(50, marks=pytest.mark.slow)])
@pytest.mark.parametrize("kind", KINDS)
def test_a_damaged_file_is_refused_or_says_the_same(kind, times, made):
    folder, before = made(kind)
    path = folder / KINDS[kind].file
    whole = path.read_bytes()
    rng = np.random.default_rng(len(kind))
    wrong, refused = [], 0
    for name, damage in DAMAGES.items():
        for k in range(times):
            damaged = damage(whole, rng)
            path.write_bytes(damaged)
            try:
                if KINDS[kind].read(folder) != before:
                    wrong.append((name, k, "read as something else"))
            except ArgumentError:
                refused += 1
            except Exception as error:
                wrong.append((name, k, repr(error)[:120]))
            assert path.read_bytes() == damaged
    path.write_bytes(whole)
    assert not wrong, "\n".join(map(str, wrong))
    assert refused >= 5 * times


@pytest.mark.parametrize("object_", [0, 1])
@pytest.mark.parametrize("damage", ["no size", "size beyond the heap"])
def test_a_heap_without_an_end_is_refused(object_, damage, tmp_path):
    """HDF5 itself goes on forever, wherever in the file the heap is."""
    KINDS["measurement"].make(tmp_path)
    path = tmp_path / KINDS["measurement"].file
    with h5py.File(path, "a") as file:  # texts fill several heaps
        for k in range(2000):
            file.attrs[f"text {k}"] = "x" * 600
    KINDS["measurement"].read(tmp_path)
    whole = path.read_bytes()
    at = whole.rindex(b"GCOL")
    assert at > 2**20
    first = at + 16
    length = int.from_bytes(whole[first + 8 : first + 16], "little")
    place = first + object_ * (16 + (length + 7) // 8 * 8)
    wrong = {"no size": bytes(16), "size beyond the heap": b"\1" + bytes(7) + b"\xf0" + b"\xff" * 7}
    path.write_bytes(whole[:place] + wrong[damage] + whole[place + 16 :])
    with pytest.raises(ArgumentError, match="its global heap is damaged"):
        KINDS["measurement"].read(tmp_path)


def test_numbers_that_are_nowhere_are_refused(tmp_path):
    """HDF5 itself reads NaN where an index of zero says that they are."""
    KINDS["measurement"].make(tmp_path)
    path = tmp_path / KINDS["measurement"].file
    with h5py.File(path) as file:
        place = file["B"].id.get_chunk_info(0).byte_offset.to_bytes(8, "little")
    whole = path.read_bytes()
    assert whole.count(place) == 1
    at = whole.index(place)
    path.write_bytes(whole[:at] + bytes(32) + whole[at + 32 :])
    with pytest.raises(ArgumentError, match="has lost what B held"):
        KINDS["measurement"].read(tmp_path)


def test_a_renamed_shard_is_refused(tmp_path):
    config = CONFIG.model_copy(update={"shard_size": 2})
    shards.generate(config, tmp_path)
    first, second = (shards.shard_path(tmp_path, k) for k in (0, 1))
    first.write_bytes(second.read_bytes())
    with pytest.raises(ArgumentError, match="realizations of another shard"):
        shards.generate(config, tmp_path)
    assert first.read_bytes() == second.read_bytes()
