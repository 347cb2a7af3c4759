"""What is measured of a relative motion: its errors, and chances of mating missed or imagined.

Signals are judged after `record.settling`.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.mating import Limits, compare_chances, find_chances
from owtsweep.studies.base.contest import WAIT
from owtsweep.studies.mating.joining import Relative

#: Criteria of the maps -> what the title of a map says.
CRITERIA = {
    "relative": "root relative to the hub: rms error of its position in space, m",
    "speed": "root relative to the hub: rms error of its velocity in space, m/s",
    "wrong": "share of moments at which a chance to mate is missed or imagined",
}
#: Further measures -> what they are.
OTHERS = {
    "chance": "share of moments at which root and hub can mate",
    "told": "share of moments at which estimates say so",
    "missed": "share of true chances that estimates do not tell",
    "false": "share of told chances that are none",
    "nees": "normalised squared error of the relative position, over 3",
}


def compare(true: Relative, told: Relative, limits: Limits, settled: int) -> dict[str, float]:
    """Compare a relative motion with the true one; return measure -> value.

    A measure that no number can be given for, such as missed chances without a chance, is left out.

    Raises
    ------
    ValueError
        If an estimate is not finite.
    """
    error = (told.position - true.position)[settled:]
    speed = (told.velocity - true.velocity)[settled:]
    if not (np.isfinite(error).all() and np.isfinite(speed).all()):
        raise ValueError("the estimate is not finite")
    can, said = (
        find_chances(motion.position[settled:], motion.velocity[settled:], limits)
        for motion in (true, told)
    )
    chances = compare_chances(can, said)
    found = {
        "relative": _rms(error),
        "speed": _rms(speed),
        "wrong": chances.wrong,
        "chance": chances.true,
        "told": chances.told,
        "missed": chances.missed,
        "false": chances.false,
    }
    if told.covariance is not None:
        solved = np.linalg.solve(told.covariance[settled:], error[:, :, None])[:, :, 0]
        found["nees"] = float(np.mean(error * solved))
    return {name: value for name, value in found.items() if not np.isnan(value)}


def list_measures(names: Iterable[str]) -> list[str]:
    """Return measures in the order of tables: criteria, then the others."""
    names = set(names)
    return [name for name in (*CRITERIA, WAIT, *OTHERS) if name in names]


def _rms(errors: Array) -> float:
    """Return the root of the mean over samples of squared lengths, errors (n, 3)."""
    return float(np.sqrt(np.mean(np.sum(errors**2, axis=1))))
