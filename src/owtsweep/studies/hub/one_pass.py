"""Holds a series that is made piece by piece, for runs that read it once from start to end."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from owtsweep.arrays import Array


class OnePassSeries:
    """A series that is read like an array (steps, lanes), but made piece by piece.

    A lane is one column. Only a part of the series is in memory. Slices must be asked for in order
    of time: when the next piece is made, the rows before the current slice are dropped. Asking for
    a dropped row raises IndexError.

    Parameters
    ----------
    pieces
        Iterator over arrays of successive rows.
    shape
        Shape of the whole series: number of steps, number of lanes.
    """

    def __init__(self, pieces: Iterator[Array], shape: tuple[int, int]) -> None:
        self.shape = shape
        self._pieces = pieces
        self._rows: Array = np.empty((0, shape[1]))
        self._first = 0

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, part: slice) -> Array:
        begin, stop, _ = part.indices(self.shape[0])
        if begin < self._first:
            raise IndexError(
                f"row {begin} has been forgotten; the first row in memory is {self._first}"
            )
        while self._first + len(self._rows) < stop:
            kept = self._rows[begin - self._first :]
            self._first += len(self._rows) - len(kept)
            self._rows = np.concatenate([kept, next(self._pieces)])
        return self._rows[begin - self._first : stop - self._first]
