"""Reduces long series to fewer points without a visible change of the figure."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array

#: Points of a series over the width of a figure: more than the figure's pixels.
POINTS = 4000


def decimate(time: Array, values: Array, points: int = POINTS) -> tuple[Array, Array]:
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
