"""Puts a span of steps of eight records into rows of eight lanes, in calls without the GIL."""

from __future__ import annotations

from owtsweep.compiled import njit


@njit
def gather(first, count, lead, sources, rows):
    """Put the steps first ... first + count - 1 of series into lanes, one series in each lane.

    The first step goes to row `lead` of `rows`.
    """
    for i in range(count):
        for lane in range(len(sources)):
            rows[lead + i, lane] = sources[lane][first + i]


@njit
def noise(count, lead, normals, begun, bias, imu, force):
    """Turn unit normals into the noise of the specific force; write it to groups 1 (x) and 2 (y).

    `normals` has the shape (lanes, 4, steps): bias_x, imu_x, bias_y, imu_y. `force` has the shape
    (groups, rows, lanes); the first step goes to row `lead`. If `begun`, the bias continues from
    `bias`, shape (lanes, 2); otherwise it starts at its initial value. `bias` is updated. `imu` is
    (walk, initial, sigma, gravity): standard deviation of the bias' change per step, initial bias,
    standard deviation of a sample's noise, and gravity (2,) in NED, all in m/s^2.
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
    """Compute the whole series of x and y at an amplitude: motion plus noise.

    The groups of `force` are motion, noise of x and noise of y. The groups of `result` are x and y;
    their rows from `lead` to lead + count - 1 are written.
    """
    for axis in range(2):
        for i in range(lead, lead + count):
            for lane in range(force.shape[2]):
                moved = amplitude * force[0, i, lane] * direction[axis]
                result[axis, i, lane] = moved + force[1 + axis, i, lane]


@njit
def keep_lead(lead, rows):
    """Copy the last `lead` rows of each group to the front; the next span will follow them."""
    last = rows.shape[1] - lead
    for group in range(rows.shape[0]):
        for i in range(lead):
            for lane in range(rows.shape[2]):
                rows[group, i, lane] = rows[group, last + i, lane]
