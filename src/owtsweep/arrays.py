"""Defines `Array`, the type of arrays in signatures; makes arrays aligned in memory, or growing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: `np.floating` rather than `np.float64`, because NumPy's functions are annotated with it.
Array = NDArray[np.floating[Any]]
#: An array of records, each with some numbers side by side, the lanes, in every field. Compiled
#: kernels know how many lanes there are and that fields do not overlap, so LLVM makes vectors.
Rows = NDArray[np.void]

#: Bytes of a cache line.
LINE = 64


def aligned(*shape: int) -> Array:
    """Return an array of zeros of this shape whose memory begins at a cache line, for kernels.

    A row of eight numbers is as long as a cache line. A row that began inside one would lie across
    two, and each access to the row would touch both.
    """
    size = 8 * math.prod(shape)
    raw = np.zeros(size + LINE, dtype=np.uint8)
    skipped = -raw.ctypes.data % LINE
    return raw[skipped : skipped + size].view(np.float64).reshape(shape)


def make_rows(count: int, lanes: int, *fields: str) -> Rows:
    """Make rows, all zero, with `lanes` numbers in each of the named fields.

    Two kinds of rows should not begin with the same fields: numba would take one for the other.
    """
    return make_mixed_rows([(field, lanes) for field in fields], count)


def make_mixed_rows(fields: list[tuple[str, int]], count: int) -> Rows:
    """Make rows, all zero, whose fields are named with their numbers of lanes."""
    kind: Any = np.dtype([(name, np.float64, (lanes,)) for name, lanes in fields])
    return np.asarray(aligned(count, kind.itemsize // 8).view(kind)[:, 0])


class Past:
    """The last columns of an array that grows.

    rows, kept: number of rows, and of columns that are kept.
    """

    def __init__(self, rows: int, kept: int) -> None:
        # twice as long, so that it is seldom moved
        self._columns, self._kept, self._stop = np.empty((rows, 2 * kept)), kept, 0

    @property
    def values(self) -> Array:
        """The columns that are kept, shape (rows, up to `kept`), until more are added."""
        return self._columns[:, max(self._stop - self._kept, 0) : self._stop]

    def add(self, values: Sequence[Array]) -> None:
        """Add columns, given as rows of one length, at most `kept`."""
        count = len(values[0])
        if self._stop + count > self._columns.shape[1]:
            last = self.values
            self._columns[:, : self._kept] = last
            self._stop = self._kept
        self._columns[:, self._stop : self._stop + count] = values
        self._stop += count
