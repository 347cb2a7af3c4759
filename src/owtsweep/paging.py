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


class _Mapping(mmap.mmap):
    """A mapped file that knows the file, and where in memory it begins."""

    file: IO[bytes]
    address: int


def room(*shape: int) -> Array:
    """Zeros (*shape), outside the process' memory if it is long."""
    possible = hasattr(mmap, "MADV_DONTNEED") and hasattr(os, "posix_fallocate")
    if shape[0] > KEPT_ROWS and possible:
        size = 8 * int(np.prod(shape))
        try:
            file = tempfile.TemporaryFile()  # noqa: SIM115 (it lives as long as the array)
            # room on the disk now: to run out of it at a later write would end the process
            os.posix_fallocate(file.fileno(), 0, size)
            mapping = _Mapping(file.fileno(), size)
        except OSError:
            return aligned(*shape)
        array: Array = np.ndarray(shape, buffer=mapping)
        mapping.file, mapping.address = file, array.ctypes.data
        return array
    return aligned(*shape)


def release(array: NDArray[Any], first: int = 0, stop: int | None = None) -> None:
    """Give back the memory of rows first ... stop - 1, if the array is one of `room` or a part.

    Whole pages only, so a row or two at either end may be read from the file again.
    """
    mapping = _mapping(array)
    if mapping is None or len(array) == 0:
        return
    stop = len(array) if stop is None else min(stop, len(array))
    before, row = _offset(array, mapping), array.strides[0]
    start = (before + first * row) // mmap.PAGESIZE * mmap.PAGESIZE
    end = before + stop * row
    if stop < len(array):
        end = end // mmap.PAGESIZE * mmap.PAGESIZE
    if end > start:
        mapping.madvise(mmap.MADV_DONTNEED, start, end - start)


def fill(array: Array, values: Array) -> None:
    """Write all of a contiguous array: past the mapping, if the array is a part of one.

    Page by page, a file system takes as long as the numbers took to make.
    """
    mapping = _mapping(array)
    if mapping is None:
        array[...] = values
        return
    left = memoryview(np.ascontiguousarray(values, dtype=array.dtype).data).cast("B")
    at = _offset(array, mapping)
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
