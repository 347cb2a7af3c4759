"""A series that is made as it is needed, for runs that go through it once from front to back."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from owtsweep.arrays import Array


class Rows:
    """Stands for a (steps, lanes) array in the batch engine and holds but a piece of it.

    Slices must be asked for in order: what lies before the last one's first row is forgotten when
    the next piece is made.

    Parameters
    ----------
    pieces
        The rows, some at a time.
    shape
        Of the whole.
    """

    def __init__(self, pieces: Iterator[Array], shape: tuple[int, int]) -> None:
        self.shape = shape
        self._pieces = pieces
        self._held: Array = np.empty((0, shape[1]))
        self._first = 0

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, part: slice) -> Array:
        begin, stop, _ = part.indices(self.shape[0])
        if begin < self._first:
            raise IndexError(f"row {begin} has been forgotten; the first one held is {self._first}")
        while self._first + len(self._held) < stop:
            kept = self._held[begin - self._first :]
            self._first += len(self._held) - len(kept)
            self._held = np.concatenate([kept, next(self._pieces)])
        return self._held[begin - self._first : stop - self._first]
