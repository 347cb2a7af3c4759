"""Between accelerations of the basin's frame and what accelerometers fixed to the body feel.

Angles are roll, pitch, yaw, turned in the order yaw, pitch, roll (Mehammer et al. 2018, section
2.2). The frame is NED: its third axis points down, so a body at rest feels (0, 0, -g).
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.inertial.angles import make_rotation
from owtsweep.gravity import GRAVITY

#: Angles to first order, or the full equations.
Kinematics = Literal["small", "exact"]
#: Pitch in rad beyond which rates of Euler angles lose their meaning (89 degrees).
STEEPEST = np.deg2rad(89.0)


def find_specific_force(angles: Array, acceleration: Array, kinematics: Kinematics) -> Array:
    """Return what ideal accelerometers fixed to the body read, m/s^2, shape (steps, 3).

    Parameters
    ----------
    angles
        Euler angles in rad, shape (steps, 3).
    acceleration
        Acceleration of the body's origin in the basin's frame, m/s^2, shape (steps, 3).
    kinematics
        With "small", only gravity is turned, by angles to first order.
    """
    felt = acceleration.copy()
    felt[:, 2] -= GRAVITY
    if kinematics == "small":
        felt[:, 0] += GRAVITY * angles[:, 1]
        felt[:, 1] -= GRAVITY * angles[:, 0]
        return felt
    return np.asarray(np.einsum("nji,nj->ni", make_rotation(angles), felt))


def hold(reported: Array) -> Array:
    """Return the last report of each sample, shape (steps, columns); zeros before the first.

    A sample with a NaN has no report.
    """
    there = np.isfinite(reported).all(axis=1)
    last = np.maximum.accumulate(np.where(there, np.arange(len(reported)), -1))
    return np.where(last[:, None] >= 0, reported[last], 0.0)


def level(force: Array, angles: Array, how: Literal["level", "small", "reported"]) -> Array:
    """Return accelerations of the translations in m/s^2, shape (steps, 3).

    Parameters
    ----------
    force
        Specific force in the body's frame, m/s^2, shape (steps, 3).
    angles
        Euler angles in rad, shape (steps, 3).
    how
        "reported": it is turned by the angles. "small": only gravity is, to first order. "level":
        it counts as the acceleration without gravity.
    """
    found = force.copy()
    if how == "small":
        found[:, 0] -= GRAVITY * angles[:, 1]
        found[:, 1] += GRAVITY * angles[:, 0]
    elif how == "reported":
        found = np.einsum("nij,nj->ni", make_rotation(angles), found)
    found[:, 2] += GRAVITY
    return found
