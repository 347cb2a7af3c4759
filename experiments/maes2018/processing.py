"""The paper's processing of both systems to motions of root and centre of gravity (section 3.1).

Both are re-sampled at 5 Hz by linear interpolation. A motion has nine columns: position of the root
(longitudinal, lateral, vertical), of the centre of gravity, and heading, pitch and roll.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.inertial.angles import find_angles, to_heading
from owtsweep.estimation.wahba import carry_point, find_pose
from owtsweep.studies.blade.contract import PRISMS, ROOT, Estimates, Measured, Truth

#: Results per second.
RATE = 5.0
#: Columns of a motion.
COLUMNS = (
    "root_u", "root_v", "root_w", "cog_u", "cog_v", "cog_w", "heading", "pitch", "roll",
)  # fmt: skip
ROTATIONS = COLUMNS[6:]
COG = np.zeros(3)


class Motions(NamedTuple):
    """Motions of one record at common times (s), shape (n, 9), in m and rad."""

    time: Array
    true: Array
    inertial: Array
    stations: Array


def process(truth: Truth, estimates: Estimates, measured: Measured) -> Motions:
    """Return the motions of both systems and the true one, without what total stations miss.

    `estimates` are those of the inertial unit.
    """
    first, last = measured.prism_times[[0, -1]]
    end = min(last, (len(truth.root) - 1) * truth.step)
    time = np.arange(np.ceil(max(first, 0.0) * RATE), np.floor(end * RATE)) / RATE
    samples = truth.step * np.arange(len(truth.root))
    flat = measured.prisms.reshape(len(measured.prisms), -1)
    prisms = resample(measured.prism_times, flat, time).reshape(len(time), *PRISMS.shape)
    return Motions(
        time,
        resample(samples, _describe(truth.root, truth.rotation), time),
        resample(samples, _describe(estimates.root, estimates.rotation), time),
        describe_prisms(prisms),
    )


def describe_prisms(prisms: Array) -> Array:
    """Return the motion of prisms (n, 3, 3): Eqs. 4 to 8, and Eqs. 9 to 11."""
    origin, rotation = find_pose(PRISMS, prisms, about="first")
    return _describe(carry_point(origin, rotation, ROOT), rotation)


def resample(times: Array, values: Array, wanted: Array) -> Array:
    """Interpolate the columns of values (n, k) linearly, shape (m, k)."""
    return np.column_stack([np.interp(wanted, times, column) for column in values.T])


def _describe(root: Array, rotation: Array) -> Array:
    """Return the motion of a root and an attitude: Eqs. 1 and 2."""
    cog = carry_point(root, rotation, COG - ROOT)
    return np.concatenate([root, cog, to_heading(find_angles(rotation))], axis=1)


def find_angles_as_printed(rotations: Array) -> Array:
    """Return heading, pitch and roll, rad, shape (samples, 3), by Eqs. 9 to 11 as they are printed.

    Quotients are clipped to [-1, 1], which rounding may exceed. Angles below 1e-8 rad become 0.

    Parameters
    ----------
    rotations
        Shape (samples, 3, 3).
    """
    T = np.moveaxis(rotations, 0, -1)
    in_plane = np.sqrt(T[0, 0] ** 2 + T[1, 0] ** 2)
    psi = -sign(T[1, 0]) * arccos(T[0, 0], in_plane)
    theta = -sign(T[2, 0]) * arccos(in_plane, np.sqrt(in_plane**2 + T[2, 0] ** 2))
    numerator = T[0, 1] * np.sin(psi) + T[1, 1] * np.cos(psi)
    whole = np.sqrt(T[0, 1] ** 2 + T[1, 1] ** 2 + T[2, 1] ** 2)
    return np.column_stack([psi, theta, sign(T[2, 1]) * arccos(numerator, whole)])


def sign(values: Array) -> Array:
    """Return 1 where values are 0 or more and -1 elsewhere, as below Eq. 11."""
    return np.where(values >= 0.0, 1.0, -1.0)


def arccos(leg: Array, hypotenuse: Array) -> Array:
    """Return the arccos, rad, of a quotient that rounding may have pushed beyond 1."""
    return np.asarray(np.arccos(np.clip(leg / hypotenuse, -1.0, 1.0)))
