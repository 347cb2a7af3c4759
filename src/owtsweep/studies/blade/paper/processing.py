"""The paper's processing of both systems to motions of root and centre of gravity (section 3.1).

Both are re-sampled at 5 Hz by linear interpolation. A motion has nine columns: position of the root
(longitudinal, lateral, vertical), of the centre of gravity, and heading, pitch and roll.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.blade_angles import find_angles
from owtsweep.estimation.wahba import carry_point, find_pose
from owtsweep.studies.blade.contract import PRISMS, ROOT, Estimates, Measured, Truth

#: Results per second.
RATE = 5.0
#: Columns of a motion.
COLUMNS = (
    "root_u", "root_v", "root_w", "cog_u", "cog_v", "cog_w", "heading", "pitch", "roll",
)  # fmt: skip
TRANSLATIONS, ROTATIONS = COLUMNS[:6], COLUMNS[6:]
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
    return np.concatenate([root, cog, find_angles(rotation)], axis=1)
