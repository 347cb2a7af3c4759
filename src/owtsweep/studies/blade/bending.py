"""How a blade that hangs in its gripper bends: under its own weight, and in its first mode.

The frame of the blade is that of its stiff root end, where the root, the inertial unit and the
first antenna are: the truth of a record is theirs, bent or not. What lies farther out is off the
rigid blade by a parabola. A cantilever that is clamped at the hook has that shape near its clamp,
and seen from another point of the blade a parabola is the same parabola.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from owtsweep.arrays import Array
from owtsweep.estimation.inertial.angles import from_heading, make_rotation
from owtsweep.gravity import GRAVITY
from owtsweep.motion.lines import Series, draw_lines, find_frequencies, respond, sample
from owtsweep.streams import Streams
from owtsweep.studies.blade.config import BladeConfig
from owtsweep.studies.blade.contract import PRISMS, UNIT

#: Where the parabola begins along the blade, and from there to the third prism, m.
CLAMP = float(UNIT[0])
REACH = float(PRISMS[2, 0]) - CLAMP


def shift(bending: CubicSpline, points: Array, times: Array) -> Array:
    """Return by what points of the body (k, 3) are off the rigid blade, m, shape (n, k, 3).

    In the body's frame. Cross-sections stay plane and turn with the slope of the blade, so a point
    beside the middle line moves along the blade, too. `bending` is as of `make_bending`.
    """
    out = np.maximum(points[:, 0] - CLAMP, 0.0) / REACH
    bent = bending(times)[:, None, :]
    shifted = np.empty((len(bent), *points.shape))
    shifted[..., 1:] = out[:, None] ** 2 * bent
    shifted[..., 0] = -2.0 / REACH * out * np.sum(points[:, 1:] * bent, axis=2)
    return shifted


def make_bending(
    config: BladeConfig, draws: Streams, series: Series, steps: int, lead: int
) -> CubicSpline | None:
    """Return the bending of a record whose rigid motion is `series`; None if nothing bends.

    It gives, at times in s, shifts of the blade at the third prism across the blade, along y and z
    of the body, m, shape (n, 2).

    The blade sags as the specific force at its centre of gravity pulls it, at once: its mode is
    faster than the hook's swing. The vibration has a stream of its own.
    """
    bending, step = config.motion.bending, 1.0 / config.record.rate
    if bending.sag == 0.0 and bending.vibration == 0.0:
        return None
    felt = series.acceleration[:, :3] + np.array([0.0, 0.0, GRAVITY])
    rotation = make_rotation(from_heading(series.position[:, 3:]))
    deflection = -bending.sag / GRAVITY * np.einsum("nji,nj->ni", rotation, felt)[:, 1:]
    frequency = find_frequencies(steps, step)
    density = respond(frequency, bending.period, bending.damping)
    lines = draw_lines(density, draws("bending"))
    deflection[:, 1] += bending.vibration * sample(lines, steps, step, lead).position[:, 0]
    return CubicSpline(step * np.arange(-lead, steps), deflection)
