"""Reduce a long series to the points that a plot needs, while the series comes piece by piece."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.figures.lines import POINTS


class Envelope:
    """A long series reduced to few points, for a plot; the series may come piece by piece.

    The series is divided into spans. The points are the least and the greatest value of each span,
    and the first and the last value of the series.

    Parameters
    ----------
    steps
        Length of the series. The values must be finite; values beyond this length are ignored.
    points
        A series of at most this many values is kept as it is. A longer series has points / 2 spans.
    """

    def __init__(self, steps: int, points: int = POINTS) -> None:
        self.steps = steps
        spans = steps if steps <= points else max(points // 2, 1)
        self._edges = np.linspace(0, steps, spans + 1).astype(int)
        self._least = np.full(spans, np.inf)
        self._greatest = np.full(spans, -np.inf)
        self._at = np.zeros((2, spans), dtype=np.int64)
        self._ends = np.zeros(2)
        self._added = 0

    def add(self, values: Array) -> None:
        """Add the next values of the series, shape (n,)."""
        begin = self._added
        values = values[: max(self.steps - begin, 0)]
        self._added = end = begin + len(values)
        if begin == end:
            return
        first = int(np.searchsorted(self._edges, begin, "right")) - 1
        last = int(np.searchsorted(self._edges, end - 1, "right"))
        for span in range(first, last):
            low = max(int(self._edges[span]), begin)
            part = values[low - begin : int(self._edges[span + 1]) - begin]
            i, j = int(np.argmin(part)), int(np.argmax(part))
            if part[i] < self._least[span]:
                self._least[span], self._at[0, span] = part[i], low + i
            if part[j] > self._greatest[span]:
                self._greatest[span], self._at[1, span] = part[j], low + j
        if begin == 0:
            self._ends[0] = values[0]
        self._ends[1] = values[-1]

    def points(self) -> tuple[Array, Array]:
        """Return the steps and the values of the kept points, shape (n,) each, in order of time."""
        steps = np.concatenate([[0, self.steps - 1], *self._at]).astype(int)
        values = np.concatenate([self._ends, self._least, self._greatest])
        steps, first = np.unique(steps, return_index=True)
        return steps, values[first]
