"""How a recorded lift begins: where the inertial unit is, and how the blade is turned.

The tilt is that of the averaged specific force, which points upwards if the blade hardly moves. The
heading of a hanging blade cannot be observed in a record (F10 of docs/blade.md): it is given, or
that of the line between two antennas.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.studies.blade.contract import Start
from owtsweep.studies.blade.recorded import Recorded

#: Seconds whose fixes give the velocity at the start.
STRAIGHT = 1.0
#: A line between antennas that is steeper than this has no heading.
STEEPEST = 0.9


def align(recorded: Recorded, force: Array, fixes: Array, step: float) -> Start:
    """Return how a recorded lift begins.

    `force` is the specific force in the blade's axes, m/s^2, shape (steps, 3). `fixes` are
    positions of antennas in the frame, m, shape (steps, k, 3); NaN where none is, but for the first
    antenna at the first sample. Raise `InputError` if the heading is unknown.
    """
    rotation = find_attitude(recorded, force, fixes, step)
    geometry = recorded.geometry
    lever = geometry.levers[0]
    first = fixes[: round(STRAIGHT / step) + 1, 0]
    there = np.flatnonzero(np.isfinite(first[:, 0]))
    velocity = np.zeros(3)
    if len(there) > 1:
        velocity = np.polyfit(step * there, first[there], 1)[0]
    tilt, heading = np.deg2rad([recorded.tilt_sigma, recorded.heading_sigma])
    reach = float(np.linalg.norm(lever))
    sigma = np.array([0.01 + reach * max(tilt, heading), recorded.velocity_sigma, tilt, heading])
    place = fixes[0, 0] - rotation @ lever
    return Start((np.stack([place, velocity]), rotation), sigma, geometry)


def find_attitude(recorded: Recorded, force: Array, fixes: Array, step: float) -> Array:
    """Return the attitude at the start, shape (3, 3); parameters are those of `align`."""
    if recorded.attitude is not None:
        given = Rotation.from_quat(recorded.attitude, scalar_first=True)
        return np.asarray(given.as_matrix())
    up = force[: max(round(recorded.alignment / step), 1)].mean(axis=0)
    up /= np.linalg.norm(up)
    if recorded.heading is not None:
        # rows: the frame's axes as the body sees them; x of the body points to the heading
        level = np.array([1.0, 0.0, 0.0]) - up[0] * up
        size = float(np.linalg.norm(level))
        require(
            size > 1.0 - STEEPEST,
            "recorded.heading: the blade's x axis is upright at the start, so it has no heading; "
            "give recorded.attitude",
        )
        along = level / size
        leveled = np.stack([along, np.cross(up, along), up])
        turned = Rotation.from_euler("z", -recorded.heading, degrees=True).as_matrix()
        return np.asarray(turned @ leveled)
    both = np.flatnonzero(np.isfinite(fixes[:, :2]).all(axis=(1, 2)))
    if fixes.shape[1] < 2 or len(both) == 0:
        raise InputError(
            "recorded.heading: the heading is unknown, and cannot be observed on a hanging blade; "
            "give it in degrees, or a second antenna by recorded.gnss=[FIRST,SECOND]"
        )
    line = fixes[both[0], 1] - fixes[both[0], 0]
    of_body = recorded.geometry.antennas[1] - recorded.geometry.antennas[0]
    upright = abs(float(of_body @ up)) / float(np.linalg.norm(of_body))
    require(
        upright < STEEPEST,
        "recorded.antennas: the line from the first to the second antenna is upright, so it shows "
        "no heading; give recorded.heading",
    )
    # upwards is exact, the line shows the heading alone
    found, _ = Rotation.align_vectors(
        np.stack([[0.0, 0.0, 1.0], line]), np.stack([up, of_body]), weights=[np.inf, 1.0]
    )
    return np.asarray(found.as_matrix())
