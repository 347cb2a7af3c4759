"""Reduce time series to lines with a moderate number of points; gaps are kept."""

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
    """Make a line of about `POINTS` points, divided into pieces at the gaps.

    Parameters
    ----------
    time, values
        Times in s and values, shape (n,) each. Values that are not finite make a gap.
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
    """Make one line of each column of `values`, shape (n, 2); columns x and y."""
    return make_line(time, values[:, 0]), make_line(time, values[:, 1])


def clip(time: Array, values: Array, view: tuple[float, float]) -> tuple[Array, Array]:
    """Return the times and values of a series from view[0] to view[1], both in s and included.

    `time` has shape (n,); the first axis of `values` has length n.
    """
    inside = (time >= view[0]) & (time <= view[1])
    return time[inside], values[inside]


def leaves(line: Line, low: float, high: float) -> bool:
    """Return whether a value of a line is below `low` or above `high`."""
    return any(bool(np.any((values < low) | (values > high))) for _, values in line)


def decimate(time: Array, values: Array, points: int = WIDE) -> tuple[Array, Array]:
    """Reduce a series to about `points` samples and keep its visible envelope.

    The series is divided into points / 2 equal spans. Kept are the least and the greatest value of
    each span, and the first and the last sample of the series, in order of time.

    Parameters
    ----------
    time, values
        Shape (n,) each, finite.
    points
        A series of at most this many samples is returned as it is.

    Returns
    -------
    time, values
        The samples kept, at most `points` + 2.
    """
    n = len(values)
    if n <= points:
        return time, values
    spans = max(points // 2, 1)
    edges = np.linspace(0, n, spans + 1).astype(int)
    # spans shorter than the longest are padded with their last sample
    width = int(np.max(np.diff(edges)))
    samples = np.minimum(edges[:-1, None] + np.arange(width), edges[1:, None] - 1)
    table, span = values[samples], np.arange(spans)
    least, greatest = (samples[span, find(axis=1)] for find in (table.argmin, table.argmax))
    kept = np.unique(np.concatenate([[0], least, greatest, [n - 1]]))
    return time[kept], values[kept]
