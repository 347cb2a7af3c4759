"""What body-fixed sensors say of the motion in the basin's frame (NED), given an attitude."""

from __future__ import annotations

from typing import Literal

import numpy as np

from owtsweep.arrays import Array
from owtsweep.gravity import GRAVITY


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
        from scipy.spatial.transform import Rotation

        found = Rotation.from_euler("ZYX", angles[:, ::-1]).apply(found)
    found[:, 2] += GRAVITY
    return found


def turn_rates(rate: Array, angles: Array) -> Array:
    """Return rates of Euler angles in rad/s, of those in the body's frame, shape (steps, 3).

    This is Eq. (2) of Mehammer et al. (2018); angles are in rad.
    """
    phi, theta, _ = angles.T
    p, q, r = rate.T
    turned = np.sin(phi) * q + np.cos(phi) * r
    return np.column_stack(
        [p + np.tan(theta) * turned, np.cos(phi) * q - np.sin(phi) * r, turned / np.cos(theta)]
    )
