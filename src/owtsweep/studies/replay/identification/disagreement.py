"""Find a specific force that contradicts the positions, and say what is likely wrong with it."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.gravity import STANDARD_GRAVITY
from owtsweep.studies.replay.identification.fit import (
    Fit,
    decode,
    find_most_likely,
    scan_delays,
)
from owtsweep.studies.replay.identification.likelihood import Problem

#: The acceleration is doubted if it misses the positions by this factor more than stated.
DOUBTED = 2.0
#: Another reading of the acceleration must raise the log likelihood by this. If the acceleration is
#: right, any other reading does so with a probability below exp(-10).
EVIDENCE = 10.0
#: ... and make the misfit smaller by this factor.
SMALLER = 2.0
#: Step between the delays at which readings are compared, s.
COARSE = 0.1


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
        "the unit g instead of m/s^2": STANDARD_GRAVITY * unit,
        "the unit m/s^2 instead of g": unit / STANDARD_GRAVITY,
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

    stated, fit: the stated values, shape (4,), and the fit of the acceleration as it is.
    source: what the positions are: "fixes" or "reference".
    """
    size, expected = _measure_misfit(problem, fit.values), _measure_misfit(problem, stated)
    if not size > DOUBTED * expected:
        return ""
    _, without = find_most_likely(problem, stated, np.zeros((2, 2)))
    readings = list_readings()
    likely = {
        reading: scan_delays(problem, stated, gain, COARSE)[1] for reading, gain in readings.items()
    }
    words = max(likely, key=lambda reading: likely[reading])
    found, value = find_most_likely(problem, stated, readings[words])
    best = _measure_misfit(problem, decode(found))
    if value < max(fit.log_likelihood, without) + EVIDENCE or SMALLER * best > size:
        words = ""
    start = (
        f"the specific force contradicts the {source}: its double integral misses them by "
        f"{size:.2g} m where the stated noise explains {expected:.2g} m"
    )
    if words:
        return f"{start}; with {words} it fits {size / best:.2g} times better"
    if without > fit.log_likelihood + EVIDENCE:
        return f"{start}; without the force they are explained better"
    return ""


def _measure_misfit(problem: Problem, values: Array) -> float:
    """Return how far a position lies from what its neighbours and the IMU say, m.

    It is the rms of the third differences, in units of that of white position noise of 1 m.
    """
    parts = problem.differences
    variance = (
        problem.integral.step * values[0] ** 2 * parts.of_white[0]
        + values[1] ** 2 * parts.of_position[0] + values[2] ** 2 * parts.of_walk[0]
    )  # fmt: skip
    return float(np.sqrt(np.mean(variance / parts.of_position[0])))
