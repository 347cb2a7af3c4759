"""Writes a span of up to eight records into arrays with eight lanes, one record per lane.

A span is some thousand steps. The compiled functions run without the GIL.
"""

from __future__ import annotations

from owtsweep.compiled import njit


@njit
def gather(first, count, lead, sources, rows):
    """Copy the steps first ... first + count - 1 of up to eight series into columns of an array.

    `sources` are the series, shape (steps,) each. Series number i goes to column i of `rows`, shape
    (rows, 8); the step `first` goes to row `lead`.
    """
    for i in range(count):
        for lane in range(len(sources)):
            rows[lead + i, lane] = sources[lane][first + i]


@njit
def noise(count, lead, normals, begun, bias, imu, force):
    """Turn standard normal numbers into the noise of `count` samples of specific force, m/s^2.

    The noise is white noise plus the IMU's bias (a random walk) minus gravity.

    Parameters
    ----------
    lead
        The row of `force` to which the first sample goes.
    normals
        Standard normal numbers, shape (lanes, 4, steps). The second axis is: bias in x, white noise
        in x, bias in y, white noise in y.
    begun, bias
        The bias at the sample before the first, shape (lanes, 2). Unless `begun` is true, there is
        no such sample, and the bias starts at its initial value. `bias` is updated to the last
        sample.
    imu
        (walk, initial, sigma, gravity): standard deviation of the bias' change per step, initial
        bias, standard deviation of the white noise, and gravity (2,) in NED, all in m/s^2.
    force
        Array (groups, rows, lanes). The noise of x is written to group 1, the noise of y to group
        2.
    """
    walk, initial, sigma, gravity = imu
    for axis in range(2):
        for lane in range(normals.shape[0]):
            drawn, white = normals[lane, 2 * axis], normals[lane, 2 * axis + 1]
            value = bias[lane, axis]
            for i in range(count):
                if i > 0 or begun:
                    value = value + drawn[i] * walk
                else:
                    value = initial
                force[1 + axis, lead + i, lane] = (white[i] * sigma + value) - gravity[axis]
            bias[lane, axis] = value


@njit
def whole_series(count, lead, amplitude, direction, force, result):
    """Compute the specific force in x and y at an amplitude (m): scaled motion plus noise, m/s^2.

    `force` has the shape (3, rows, lanes): the motion's acceleration along the wave at unit
    amplitude, the noise of x, the noise of y. `direction` holds the wave's direction cosines, shape
    (2,). `count` rows of `result`, shape (2, rows, lanes), are written from row `lead` on: x, then
    y.
    """
    for axis in range(2):
        for i in range(lead, lead + count):
            for lane in range(force.shape[2]):
                moved = amplitude * force[0, i, lane] * direction[axis]
                result[axis, i, lane] = moved + force[1 + axis, i, lane]


@njit
def keep_lead(lead, rows):
    """Copy the last `lead` rows of each group of lanes to the group's first rows.

    `rows` has the shape (groups, rows, lanes), and holds a span of records (some thousand steps).
    The next span will be written behind the copied rows.
    """
    last = rows.shape[1] - lead
    for group in range(rows.shape[0]):
        for i in range(lead):
            for lane in range(rows.shape[2]):
                rows[group, i, lane] = rows[group, last + i, lane]
