"""Long arrays outside the process' memory: in nameless temporary files that are mapped.

Such an array is used like any other. What has been worked through is given back by `release`: it
stays in the file, for which the system keeps what memory it can spare, and comes back unchanged
when it is next read. Where there is no such file (no room, no such system) arrays lie in memory.
"""

from __future__ import annotations

import mmap
import os
import tempfile
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array, aligned

#: Arrays of no more rows stay in memory: those of records of 2000 s at 100 Hz. Reading the gains of
#: these from a file takes a tenth of a block's time; 50_000 makes memory flat from 500 s on.
KEPT_ROWS = 200_000
#: Bytes that `packed` writes at once. The system keeps in one piece what was written in one, and
#: maps it with one page fault; more of them would show in the process' memory.
PIECE = 2**19


#: Files to be used again, all of one size in bytes: each block of a sweep asks for one, and for the
#: system to give up a file's pages and find new ones takes a tenth of the time of making motion.
_SPARE: dict[int, list[IO[bytes]]] = {}


class _Mapping(mmap.mmap):
    """A mapped file that knows the file, and where in memory it begins."""

    file: IO[bytes]
    address: int
    spare: list[IO[bytes]]

    def __del__(self) -> None:
        if hasattr(self, "spare"):
            self.spare.append(self.file)


def room(*shape: int, again: bool = False) -> Array:
    """Zeros (*shape), outside the process' memory if it is long.

    again: it is one of many of this size, made one after the other; its file is kept for the next
    until `forget`, or until such an array of another size is made. It may hold anything.
    """
    possible = hasattr(mmap, "MADV_DONTNEED") and hasattr(os, "posix_fallocate")
    if shape[0] > KEPT_ROWS and possible:
        size = 8 * int(np.prod(shape))
        try:
            file = _spare_file(size) if again else None
            if file is None:
                file = tempfile.TemporaryFile()  # noqa: SIM115 (it lives as long as the array)
                # room on the disk now: to run out of it at a later write would end the process
                os.posix_fallocate(file.fileno(), 0, size)
            mapping = _Mapping(file.fileno(), size)
        except OSError:
            return aligned(*shape)
        array: Array = np.ndarray(shape, buffer=mapping)
        mapping.file, mapping.address = file, array.ctypes.data
        if again and size in _SPARE:
            mapping.spare = _SPARE[size]
        return array
    return aligned(*shape)


def _spare_file(size: int) -> IO[bytes] | None:
    """A file of so many bytes that nobody uses any more."""
    if size not in _SPARE:
        forget()
        _SPARE[size] = []
    try:
        return _SPARE[size].pop()
    except (KeyError, IndexError):  # another thread was faster
        return None


def forget() -> None:
    """Close the files that `room` keeps for arrays to come."""
    _SPARE.clear()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=forget)  # a file serves one process alone


def release(array: NDArray[Any], first: int = 0, stop: int | None = None) -> None:
    """Give back the memory of rows first ... stop - 1, if the array is one of `room` or a part.

    Whole pieces, since a page fault may map a whole one, so some rows at either end may be read
    from the file again.
    """
    mapping = _mapping(array)
    if mapping is None or len(array) == 0:
        return
    stop = len(array) if stop is None else min(stop, len(array))
    before, row = _offset(array, mapping), array.strides[0]
    if stop > first:
        start = (before + first * row) // PIECE * PIECE
        end = min(-(-(before + stop * row) // PIECE) * PIECE, len(mapping))
        mapping.madvise(mmap.MADV_DONTNEED, start, end - start)


def fill(array: Array, values: Array, scale: float = 1.0) -> None:
    """Write scale * values into a contiguous array: past the mapping, if it is a part of one.

    Page by page, a file system takes as long as the numbers took to make.
    """
    mapping = _mapping(array)
    if mapping is None:
        np.multiply(values, scale, out=array)
        return
    at, row = _offset(array, mapping), array.strides[0]
    rows = max(PIECE // row, 1)  # so that products are still in the cache when they are written
    for first in range(0, len(array), rows):
        piece = np.multiply(values[first : first + rows], scale, dtype=array.dtype, order="C")
        _write(mapping, at + first * row, memoryview(piece.data).cast("B"))


def packed(array: Array) -> Array:
    """A contiguous long array's copy that the system maps by large pieces; another one as it is.

    An array that was written through its mapping lies in the system's smallest pages, and to map
    them and give them back costs more than to read what is in them. For what is read many times.
    """
    if _mapping(array) is None:
        return array
    result = room(*array.shape)
    mapping = _mapping(result)
    if mapping is None:
        return array
    left, row = memoryview(array.data).cast("B"), array.strides[0]
    for at in range(0, len(left), PIECE):  # from multiples of it: elsewhere pieces are cut smaller
        # a copy: of memory that is not there yet the system writes zeros first, then asks again
        _write(mapping, at, memoryview(bytes(left[at : at + PIECE])))
        release(array, at // row, (at + PIECE) // row)
    return result


def outside(array: Array) -> bool:
    """Whether an array lies in a file, so that `read` serves better than its mapping."""
    return _mapping(array) is not None


def read(array: Array, first: int, out: Array) -> None:
    """Copy rows first ... first + len(out) - 1 of a contiguous array into another one.

    From the file itself, if the array lies in one: its pages are neither mapped nor in need of
    `release`.
    """
    mapping = _mapping(array)
    if mapping is None:
        out[...] = array[first : first + len(out)]
        return
    left = memoryview(out.data).cast("B")
    at = _offset(array, mapping) + first * array.strides[0]
    while len(left):
        count = os.preadv(mapping.file.fileno(), [left], at)
        left, at = left[count:], at + count


def _write(mapping: _Mapping, at: int, left: memoryview) -> None:
    while len(left):
        count = os.pwrite(mapping.file.fileno(), left, at)
        left, at = left[count:], at + count


def _mapping(array: NDArray[Any]) -> _Mapping | None:
    owner: Any = array
    while isinstance(owner, np.ndarray):
        owner = owner.base
    return owner if isinstance(owner, _Mapping) else None


def _offset(array: NDArray[Any], mapping: _Mapping) -> int:
    """Bytes from the mapping's start to the array's."""
    return int(array.ctypes.data) - mapping.address
