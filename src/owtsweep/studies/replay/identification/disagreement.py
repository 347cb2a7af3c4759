"""Find a specific force that contradicts the positions, and say what is likely wrong with it."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.replay.identification.fit import Fit, decode, find_most_likely
from owtsweep.studies.replay.identification.likelihood import Problem

#: The acceleration is doubted if this many times the stated IMU sigma would be needed at least.
DOUBTED = 2.0
#: Another reading of the acceleration must raise the log likelihood by this. If the acceleration is
#: right, any other reading does so with a probability below exp(-10).
EVIDENCE = 10.0
#: ... and make the IMU's noise smaller by this factor.
SMALLER = 2.0
GRAVITY = 9.80665


def list_readings() -> dict[str, Array]:
    """Return what may be wrong, in words -> the matrix (2, 2) that corrects the acceleration."""
    unit = np.eye(2)
    swapped = unit[::-1]
    readings = {
        "its sign turned": -unit,
        "its axes swapped": swapped,
        "its axes swapped and both signs turned": -swapped,
        "the sign of x turned": np.diag([-1.0, 1.0]),
        "the sign of y turned": np.diag([1.0, -1.0]),
        "the unit g instead of m/s^2": GRAVITY * unit,
        "the unit m/s^2 instead of g": unit / GRAVITY,
        "a unit a thousand times smaller": 1e-3 * unit,
        "a unit a thousand times larger": 1e3 * unit,
    }
    for degrees in (45, 90, 135, -135, -90, -45):
        cos, sin = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
        turned = np.array([[cos, -sin], [sin, cos]])
        readings[f"sensors.yaw larger by some {degrees} deg"] = turned
    return readings


def describe_disagreement(problem: Problem, stated: Array, fit: Fit, source: str) -> str:
    """Say why the acceleration cannot belong to the positions; "" if both can be of one motion.

    Parameters
    ----------
    problem, stated, fit
        The problem, the stated values (shape (4,)), and the fit with the acceleration as it is.
    source
        What the positions are: "fixes" or "reference".
    """
    if not fit.low[0] > DOUBTED * stated[0]:
        return ""
    start = f"the specific force contradicts the {source}"
    needed = f"an IMU sigma of {fit.values[0]:.2g} m/s^2 would be needed ({stated[0]:.3g} stated)"
    best, best_value, words = fit.values[0], fit.log_likelihood + EVIDENCE, ""
    for reading, gain in list_readings().items():
        found, value = find_most_likely(problem, stated, gain)
        sigma = decode(found)[0]
        if value > best_value and SMALLER * sigma < fit.values[0]:
            best, best_value, words = sigma, value, reading
    if words:
        return f"{start}: {needed}; with {words} it fits {fit.values[0] / best:.2g} times better"
    _, without = find_most_likely(problem, stated, np.zeros((2, 2)))
    if without > fit.log_likelihood + EVIDENCE:
        return f"{start}: {needed}, and without the force the {source} are explained better"
    return ""
