"""Writes a span of up to eight records into arrays with a lane (column) for each series.

The lanes of a kind stand side by side, one per record: `WIDTH` each. The compiled functions run
without the GIL.
"""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.layout import WIDTH


@njit
def gather(first, count, lead, sources, rows, column):
    """Copy the steps first ... first + count - 1 of up to eight series into columns of an array.

    `sources` are the series, shape (steps,) each. Series number i goes to column `column` + i of
    `rows`; the step `first` goes to row `lead`.
    """
    for i in range(count):
        for lane in range(len(sources)):
            rows[lead + i, column + lane] = sources[lane][first + i]


@njit
def noise(count, lead, normals, begun, bias, imu, force):
    """Turn standard normal numbers into the noise of `count` samples of specific force, m/s^2.

    The noise is white noise plus the IMU's bias (a random walk) minus gravity.

    lead: the row of `force` to which the first sample goes.
    normals: shape (lanes, 4, steps). The second axis is: bias in x, white noise in x, bias in y,
        white noise in y.
    begun, bias: the bias at the sample before the first, shape (lanes, 2), updated to the last.
        Unless `begun` is true, there is no such sample, and the bias starts at its initial value.
    imu: (walk, initial, sigma, gravity): standard deviation of the bias' change per step, initial
        bias, standard deviation of the white noise, and gravity (2,) in NED, all in m/s^2.
    force: shape (rows, 3 WIDTH). The noise of x is written behind the first WIDTH columns, the
        noise of y behind that of x.
    """
    walk, initial, sigma, gravity = imu
    for axis in range(2):
        for lane in range(normals.shape[0]):
            drawn, white = normals[lane, 2 * axis], normals[lane, 2 * axis + 1]
            column, value = WIDTH * (1 + axis) + lane, bias[lane, axis]
            for i in range(count):
                if i > 0 or begun:
                    value = value + drawn[i] * walk
                else:
                    value = initial
                force[lead + i, column] = (white[i] * sigma + value) - gravity[axis]
            bias[lane, axis] = value


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
