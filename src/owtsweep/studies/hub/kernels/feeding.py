"""Puts a span of records into rows of eight lanes, in one call that releases the GIL."""

from __future__ import annotations

from owtsweep.compiled import njit


@njit
def gather(first, count, lead, sources, rows):
    """Put steps first ... first + count - 1 of each series into its lane, from row `lead` on."""
    for i in range(count):
        for lane in range(len(sources)):
            rows[lead + i, lane] = sources[lane][first + i]


@njit
def noise(count, lead, normals, begun, bias, imu, force):
    """Turn unit normals (lanes, 4, steps) of bias_x, imu_x, bias_y, imu_y into groups 1 and 2.

    If `begun`, the bias continues from `bias` (lanes, 2); otherwise it starts at its initial value.
    imu: (walk, initial, sigma, gravity): sigma of the bias' steps, initial bias, sigma of a sample,
    and gravity (2,) in NED.
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
    """Make the groups x and y at an amplitude from the groups motion and noise."""
    for axis in range(2):
        for i in range(lead, lead + count):
            for lane in range(force.shape[2]):
                moved = amplitude * force[0, i, lane] * direction[axis]
                result[axis, i, lane] = moved + force[1 + axis, i, lane]


@njit
def keep_lead(lead, rows):
    """Move the last `lead` rows of each group to the front, where the next span follows them."""
    last = rows.shape[1] - lead
    for group in range(rows.shape[0]):
        for i in range(lead):
            for lane in range(rows.shape[2]):
                rows[group, i, lane] = rows[group, last + i, lane]
