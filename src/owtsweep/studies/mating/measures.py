"""What is measured of a relative motion: its errors, and chances of mating missed or imagined.

Signals are judged after `record.settling`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.evaluation.measures import average_nees, compute_rms_length
from owtsweep.results.criteria import MILLIMETRE, MILLIMETRE_PER_SECOND, Criterion
from owtsweep.studies.base.schemes import NotFinite
from owtsweep.studies.mating.config import Limits
from owtsweep.studies.mating.joining import Relative

#: Criteria of the maps.
CRITERIA = {
    "relative": Criterion(
        "root relative to the hub: rms error of its position in space, m", "root", "m", *MILLIMETRE
    ),
    "speed": Criterion(
        "root relative to the hub: rms error of its velocity in space, m/s", "root", "m/s",
        *MILLIMETRE_PER_SECOND,
    ),
    "wrong": Criterion(
        "share of moments at which a chance to mate is missed or imagined", "plain", "", 0.01,
        "one moment in a hundred",
    ),
}  # fmt: skip
#: Further measures -> what they are.
OTHERS = {
    "chance": "share of moments at which root and hub can mate",
    "told": "share of moments at which estimates say so",
    "missed": "share of true chances that estimates do not tell",
    "false": "share of told chances that are none",
    "nees": "normalised squared error of the relative position, over 3",
}


def compare(
    true: Relative, estimated: Relative, limits: Limits, hold: int, settled: int
) -> dict[str, float]:
    """Compare a relative motion with the true one; return measure -> value.

    `limits` and `hold` are as for `find_chances`; samples from `settled` on are compared.
    A measure that no number can be given for, such as missed chances without a chance, is left out.
    Raise `NotFinite` if an estimate is not finite.
    """
    error = (estimated.position - true.position)[settled:]
    speed = (estimated.velocity - true.velocity)[settled:]
    if not (np.isfinite(error).all() and np.isfinite(speed).all()):
        raise NotFinite("the estimate is not finite")
    can, said = (
        find_chances(motion.position[settled:], motion.velocity[settled:], limits, hold)
        for motion in (true, estimated)
    )
    found = {
        "relative": compute_rms_length(error),
        "speed": compute_rms_length(speed),
        **compare_chances(can, said),
    }
    if estimated.covariance is not None:
        found["nees"] = average_nees(error, estimated.covariance[settled:])
    return {name: value for name, value in found.items() if not np.isnan(value)}


def find_chances(apart: Array, velocity: Array, limits: Limits, hold: int) -> NDArray[np.bool_]:
    """Return at which moments a mating may begin, shape (steps - hold + 1,).

    It may if the bodies keep within the limits from the moment on, for `hold` samples. `apart`,
    their distance from the place of mating (m), and `velocity`, that relative to each other (m/s),
    have the shape (steps, axes). Raise `ValueError` if the record is shorter than `hold`.
    """
    if len(apart) < hold:
        raise ValueError(f"{len(apart)} samples are fewer than the {hold} of a mating")
    near = np.sum(apart**2, axis=1) <= limits.distance**2
    slow = np.sum(velocity**2, axis=1) <= limits.speed**2
    count = np.concatenate([[0], np.cumsum(near & slow)])
    return np.asarray(count[hold:] - count[:-hold] == hold)


def compare_chances(can: NDArray[np.bool_], said: NDArray[np.bool_]) -> dict[str, float]:
    """Compare the moments at which a mating may begin with those of which estimates say so.

    Return measure -> share; NaN for `missed` without a chance, and for `false` if none is told.
    """
    both, chance, told = (float(np.mean(part)) for part in (can & said, can, said))
    return {
        "wrong": float(np.mean(can != said)),
        "chance": chance,
        "told": told,
        "missed": 1.0 - both / chance if chance > 0.0 else float("nan"),
        "false": 1.0 - both / told if told > 0.0 else float("nan"),
    }
