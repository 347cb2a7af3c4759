"""Writes a span of up to eight records into arrays with a lane (column) for each series.

The lanes of a kind stand side by side, one per record: `WIDTH` each. The compiled functions run
without the GIL.
"""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.layout import WIDTH


@njit
def gather(lead, sources, rows, column):
    """Copy up to eight series, shape (series, steps), into columns of an array.

    Series number i goes to column `column` + i of `rows`; its first step goes to row `lead`.
    """
    lanes, count = sources.shape
    for i in range(count):
        for lane in range(lanes):
            rows[lead + i, column + lane] = sources[lane, i]


@njit
def whole_series(count, lead, amplitude, direction, force, result):
    """Compute the specific force in x and y at an amplitude (m): scaled motion plus noise, m/s^2.

    `force`, shape (rows, 3 WIDTH), holds the motion's acceleration along the wave at unit
    amplitude, the noise of x and the noise of y. `direction` (2,) holds the wave's direction
    cosines. `count` rows of `result`, shape (rows, 2 WIDTH), are written from row `lead` on: x,
    then y.
    """
    for i in range(lead, lead + count):
        for axis in range(2):
            for lane in range(WIDTH):
                moved = amplitude * force[i, lane] * direction[axis]
                result[i, WIDTH * axis + lane] = moved + force[i, WIDTH * (1 + axis) + lane]


@njit
def keep_rows(first, stop, rows):
    """Copy the rows first ... stop - 1 of an array to its first rows."""
    for i in range(first, stop):
        for lane in range(rows.shape[1]):
            rows[i - first, lane] = rows[i, lane]
