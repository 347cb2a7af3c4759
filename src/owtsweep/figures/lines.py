"""Lines over time, reduced to a moderate number of points; gaps are kept."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.figures.decimate import decimate

if TYPE_CHECKING:
    from matplotlib.axes import Axes

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


def plot(axes: Axes, line: Line, **look: Any) -> None:
    """Draw the pieces of a line; only the first carries its label."""
    for time, values in line:
        axes.plot(time, values, **look)
        look = {key: item for key, item in look.items() if key != "label"}
