"""Lines over time, reduced to a moderate number of points; gaps are kept."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array

#: Points of a series that is alone over the width of a figure: more than the figure's pixels.
WIDE = 4000
#: Points of one line. With this number, four lines in two panels make an SVG of about 400 KiB.
POINTS = 1200

#: A line as pieces without a gap: times (s) and values, (n,) each.
Line = list[tuple[Array, Array]]
#: The lines of x and y.
Pair = tuple[Line, Line]


def make_line(time: Array, values: Array) -> Line:
    """Make a line of about `POINTS` points, divided into pieces at its gaps.

    Parameters
    ----------
    time, values
        (n,) each; values that are not finite make a gap.
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
    """Make lines of the two columns of (n, 2) values."""
    return make_line(time, values[:, 0]), make_line(time, values[:, 1])


def clip(time: Array, values: Array, view: tuple[float, float]) -> tuple[Array, Array]:
    """The part of a series that lies in a view (first and last time, s)."""
    inside = (time >= view[0]) & (time <= view[1])
    return time[inside], values[inside]


def decimate(time: Array, values: Array, points: int = WIDE) -> tuple[Array, Array]:
    """Keep the least and the greatest value in each of points / 2 equal spans, in order of time.

    So all extremes and the visible envelope of the series are kept. The first and the last sample
    are kept too.

    Parameters
    ----------
    time, values
        (n,) each, finite.
    points
        A series of no more than that many samples is returned as it is.

    Returns
    -------
    time, values
        (at most `points` + 2,) each.
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
