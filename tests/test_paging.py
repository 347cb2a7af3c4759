"""Arrays outside the process' memory: the same numbers, less of it."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from owtsweep import paging

MAPPED = Path("/proc/self/statm")


def _resident() -> int:
    """Bytes of files and of the process' own that are in memory now."""
    return int(MAPPED.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not MAPPED.exists(), reason="no /proc")
def test_what_is_released_leaves_memory_and_comes_back_unchanged():
    rows = 1_000_000
    array = paging.room(rows, 4)
    before = _resident()
    for first in range(0, rows, 10_000):
        stop = first + 10_000
        array[first:stop] = np.arange(4 * first, 4 * stop).reshape(-1, 4)
        paging.release(array[:stop], first, stop)
        assert _resident() - before < 4_000_000, first
    paging.release(array)
    assert np.array_equal(array.ravel(), np.arange(4 * rows))


def test_releasing_a_part_of_a_part_touches_no_other_rows():
    array = paging.room(500_000)
    array[:] = np.arange(len(array))
    part = array[12_345:400_001]
    paging.release(part, 7, 300_000)
    paging.release(part)
    assert np.array_equal(array, np.arange(len(array)))


def test_what_the_system_reads_and_writes_piece_by_piece_is_whole(monkeypatch):
    read, write = os.preadv, os.pwrite
    monkeypatch.setattr(os, "preadv", lambda file, parts, at: read(file, [parts[0][:1000]], at))
    monkeypatch.setattr(os, "pwrite", lambda file, part, at: write(file, part[:100_000], at))
    numbers = np.arange(500_000.0)
    array = paging.room(len(numbers))
    assert paging.outside(array)
    paging.fill(array, numbers)
    found = np.empty(20_000)
    paging.read(array, 300_000, found)
    assert np.array_equal(found, numbers[300_000:320_000])
    assert np.array_equal(array, numbers)


@pytest.mark.parametrize("missing", ["small", "full"])
def test_without_a_file_there_is_memory(missing, monkeypatch):
    if missing == "full":

        def full(*_: int) -> None:
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(paging.os, "posix_fallocate", full, raising=False)
    array = paging.room(10 if missing == "small" else 1_000_000, 2)
    assert paging._mapping(array) is None
    array[:] = 3.0
    paging.release(array)
    assert np.all(array == 3.0)


@pytest.mark.parametrize("rows", [1000, 500_000])
def test_filling_a_part_writes_that_part(rows):
    array = paging.room(rows)
    array[:] = 1.0
    paging.fill(array[100:300], 2.0 * np.arange(400.0)[::2])
    assert np.array_equal(array[100:300], 4.0 * np.arange(200))
    assert np.all(array[:100] == 1.0)
    assert np.all(array[300:] == 1.0)


@pytest.mark.parametrize("rows", [1000, 500_000])
def test_filling_multiplies_by_the_scale(rows):
    array = paging.room(rows)
    values = np.arange(float(rows))
    paging.fill(array, values, 0.1)
    assert np.array_equal(array, 0.1 * values)


@pytest.mark.parametrize("rows", [1000, 300_001])
def test_a_packed_copy_holds_the_same_numbers(rows):
    array = paging.room(rows, 3)
    array[:] = np.arange(3.0 * rows).reshape(-1, 3)
    for part in (array, array[: rows - 7]):
        packed = paging.packed(part)
        assert np.array_equal(packed, np.arange(part.size).reshape(-1, 3))
        assert (packed is part) == (not paging.outside(part))


@pytest.mark.skipif(not MAPPED.exists(), reason="no /proc")
def test_packing_and_reading_leave_nothing_in_memory():
    array = paging.room(1_000_000, 4)
    for first in range(0, 1_000_000, 10_000):
        array[first : first + 10_000] = 1.0
        paging.release(array, first, first + 10_000)
    before = _resident()
    packed, out = paging.packed(array), np.empty((10_000, 4))
    for first in range(0, 1_000_000, 10_000):
        paging.read(packed, first, out)
        assert np.all(out == 1.0)
        assert _resident() - before < 4_000_000, first


@pytest.mark.parametrize("rows", [1000, 500_000])
def test_reading_a_part_of_a_part(rows):
    array = paging.room(rows)
    array[:] = np.arange(rows)
    out = np.empty(100)
    paging.read(array[50:], 7, out)
    assert np.array_equal(out, np.arange(57, 157))


def _inode(array):
    return os.fstat(paging._mapping(array).file.fileno()).st_ino


@pytest.mark.skipif(not MAPPED.exists(), reason="no files")
def test_a_file_is_used_again_by_one_array_at_a_time():
    paging.forget()
    first, second = (paging.room(300_000, again=True) for _ in range(2))
    first[:], second[:] = 1.0, 2.0
    assert np.all(first == 1.0)
    files = {_inode(first), _inode(second)}
    assert len(files) == 2
    part = first[5:]
    del first
    assert _inode(paging.room(300_000, again=True)) not in files  # a part is still there
    paging.forget()
    del part
    third = paging.room(300_000, again=True)
    del second  # made before `forget`
    fourth = paging.room(300_000, again=True)
    fourth[:] = 4.0
    kept = _inode(fourth)
    del fourth
    assert _inode(paging.room(300_000)) != kept  # asked for once, made once
    fifth = paging.room(300_000, again=True)
    assert _inode(fifth) == kept != _inode(third)
    paging.room(400_000, again=True)
    assert list(paging._SPARE) == [8 * 400_000]


@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of fork, where there are threads
@pytest.mark.skipif(not hasattr(os, "fork") or not MAPPED.exists(), reason="no fork")
def test_a_forked_process_takes_no_file_of_its_parent():
    paging.room(300_000, again=True)
    assert any(paging._SPARE.values())
    child = os.fork()
    if child == 0:
        os._exit(len(paging._SPARE))
    assert os.waitpid(child, 0)[1] == 0
    paging.forget()
