"""Reduce time series to lines with few points for figures; gaps in the series are kept.

`Envelope` does so while a long series comes piece by piece.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array

#: Points of the only line in a panel as wide as the figure: more than the figure has pixels.
WIDE = 4000
#: Points of one line of several. With this number, four lines in two panels make an SVG of about
#: 400 KiB.
POINTS = 1200

#: A line: its pieces without a gap. Each piece has times in s and values, shape (n,) each.
Line = list[tuple[Array, Array]]
#: A line for x and a line for y.
Pair = tuple[Line, Line]


def make_line(time: Array, values: Array) -> Line:
    """Reduce a time series (n,) in s to a line of about `POINTS` points, with its gaps.

    Values that are not finite make a gap. The list of pieces is empty if no value is finite.
    """
    present = np.isfinite(values)
    if np.all(present):
        return [decimate(time, values, POINTS)]
    edges = np.flatnonzero(np.diff(np.concatenate([[0], present.astype(int), [0]])))
    pieces = []
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        share = max(int(POINTS * (end - begin) / len(values)), 8)
        pieces.append(decimate(time[begin:end], values[begin:end], share))
    return pieces


def make_pair(time: Array, values: Array) -> Pair:
    """Reduce a time series of values (n, 2) to two lines, one for x and one for y."""
    return make_line(time, values[:, 0]), make_line(time, values[:, 1])


def clip(time: Array, values: Array, view: tuple[float, float]) -> tuple[Array, Array]:
    """Return times and values (n, ...) of a series from `view[0]` to `view[1]` (s), inclusive."""
    inside = (time >= view[0]) & (time <= view[1])
    return time[inside], values[inside]


def leaves(line: Line, low: float, high: float) -> bool:
    """Return whether a value of a line is below `low` or above `high`."""
    return any(bool(np.any((values < low) | (values > high))) for _, values in line)


def decimate(time: Array, values: Array, points: int = WIDE) -> tuple[Array, Array]:
    """Reduce a series to about `points` samples that show the same extremes in a figure.

    The series, finite and of shape (n,), is divided into points / 2 equal spans. The result has the
    least and the greatest sample of each span, and the first and the last sample of the series, in
    order of time: at most `points` + 2. A series of at most `points` samples is returned unchanged.
    """
    if len(values) <= points:
        return time, values
    envelope = Envelope(len(values), points)
    envelope.add(values)
    kept, extremes = envelope.points()
    return time[kept], extremes


class Envelope:
    """A long series reduced as by `decimate`; the series may come piece by piece.

    steps: Length of the series. The values must be finite; values beyond this length are ignored.
    points: a series of at most this many values is kept as it is. A longer series has points / 2
        spans.
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
