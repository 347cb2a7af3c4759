"""The rows of long gain schedules that the kernels need next, read from their file.

A schedule that does not settle has a row for every step: 350 bytes per step and scheme. Read span
by span into the same memory they cost what spans cost, however long the record.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from owtsweep import paging
from owtsweep.arrays import Array
from owtsweep.studies.hub.kernels.layout import ChainArrays, Weights


class GainRows:
    """A chain's arrays and weights, of which only some rows are in memory.

    Parameters
    ----------
    arrays, weights
        Whole; those of no more than `paging.KEPT_ROWS` rows are taken as they are.
    rows, cycle
        Rows of the schedule and how many of them repeat in the end.
    behind
        Steps before the present ones whose rows are still needed.
    """

    def __init__(
        self, arrays: ChainArrays, weights: Weights, rows: int, cycle: int, behind: int
    ) -> None:
        self.whole = (arrays, weights)
        self.rows, self.cycle, self.behind = rows, cycle, behind
        self.filter = _long(arrays.filter, rows)
        self.weights = _long(weights, rows)

    def during(self, first: int, stop: int) -> tuple[ChainArrays, Weights]:
        """Arrays that hold the rows for the steps first ... stop - 1, until the next call."""
        arrays, weights = self.whole
        if not self.weights:
            return self.whole
        start = max(min(first - self.behind, self.rows - self.cycle), 0)
        end = min(max(stop, start + self.cycle), self.rows)
        parts: list[dict[str, Any]] = [
            {name: field.during(start, end) for name, field in fields.items()}
            for fields in (self.filter, self.weights)
        ]
        filter_arrays = arrays.filter._replace(**parts[0])
        return arrays._replace(filter=filter_arrays), weights._replace(**parts[1])


class _Window:
    """An array whose row k is that of `whole` for start <= k < end; the others are not there.

    So that the kernels go on counting rows from the record's first step, the array begins before
    its memory does, by as much as `start` rows take.
    """

    def __init__(self, whole: Array) -> None:
        self.whole, self.reader = whole, paging.Reader(whole)
        self.buffer = np.empty((0, *whole.shape[1:]))

    def during(self, start: int, end: int) -> Array:
        if len(self.buffer) < end - start:
            self.buffer = np.empty((end - start, *self.whole.shape[1:]))
        self.reader.read(start, end, self.buffer)
        return np.asarray(_Shifted(self.buffer, start, self.whole.shape))


class _Shifted:
    """What NumPy takes for an array whose row `first` is the first of a buffer."""

    def __init__(self, buffer: Array, first: int, shape: tuple[int, ...]) -> None:
        self.buffer = buffer  # kept as long as the array
        known = buffer.__array_interface__
        address = known["data"][0] - first * buffer.strides[0]
        self.__array_interface__ = {**known, "data": (address, False), "shape": shape}


def _long(fields: Any, rows: int) -> dict[str, _Window]:
    """Those of some arrays by name that have a row for every row of a long schedule."""
    if rows <= paging.KEPT_ROWS:
        return {}
    return {
        name: _Window(field)
        for name, field in fields._asdict().items()
        if isinstance(field, np.ndarray) and field.dtype == float and len(field) == rows
    }
