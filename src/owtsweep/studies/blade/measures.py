"""What is measured of estimates: errors of the root and of the attitude, and their claims.

Signals are judged after `record.settling`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from owtsweep.arrays import Array
from owtsweep.estimation.inertial.angles import find_angles
from owtsweep.evaluation.measures import average_nees, compute_rms_length
from owtsweep.results.criteria import MILLIMETRE, Criterion
from owtsweep.studies.base.contest import WAIT
from owtsweep.studies.base.schemes import NotFinite
from owtsweep.studies.blade.boom import find_boom_error
from owtsweep.studies.blade.contract import Estimates, Truth

#: Criteria of the maps.
CRITERIA = {
    "root": Criterion("position of the root: rms error in space, m", "root", "m", *MILLIMETRE),
    "attitude": Criterion(
        "attitude: rms error about all axes, deg", "root", "deg", 0.01,
        "on the length of a blade, .01 deg is a centimetre at the tip",
    ),
    "worst": Criterion(
        "position of the root: largest error in the last outage, m", "root", "m", *MILLIMETRE
    ),
}  # fmt: skip
#: Further measures -> what they are.
OTHERS = {
    "mse": "position of the root: mean squared error in space, m^2",
    "velocity": "velocity of the root: rms error in space, m/s",
    **{f"root_{name}": f"position of the root along {name}: rms error, m" for name in "xyz"},
    **{f"rms_over_p_{name}": f"rms error along {name} over the root of P" for name in "xyz"},
    **{name: f"{name}: rms error, deg" for name in ("heading", "pitch", "roll")},
    "withheld": "first antenna against fixes withheld in outages of a recorded lift: rms, m",
    "nees": "normalised squared error of the root's position, over 3",
    "nees_attitude": "normalised squared error of the attitude, over 3",
    "nis": "normalised squared innovation of a fix, over its dimension",
    "boom": "tip of the boom above .15 Hz, by its accelerometers: rms error in space, m",
}


class Judged(NamedTuple):
    """Which samples are judged: from the first settled one on, and those of the last outage."""

    settled: int
    last_outage: NDArray[np.bool_]


def compare(truth: Truth, estimates: Estimates, judged: Judged) -> dict[str, float]:
    """Compare the estimates of a record with its truth; return measure -> value.

    Raise `NotFinite` if an estimate is not finite.
    """
    cut = slice(judged.settled, None)
    error = estimates.root - truth.root
    speed = estimates.root_velocity[cut] - truth.root_velocity[cut]
    turned = find_turn(truth.rotation[cut], estimates.rotation[cut])
    if not (np.isfinite(error[cut]).all() and np.isfinite(turned).all()):
        raise NotFinite("the estimate is not finite")
    found = {
        "root": compute_rms_length(error[cut]),
        "attitude": np.rad2deg(compute_rms_length(turned)),
        "worst": np.sqrt(np.sum(error[judged.last_outage] ** 2, axis=1).max()),
        "mse": compute_rms_length(error[cut]) ** 2,
        "velocity": compute_rms_length(speed),
    }
    angles = find_angles(estimates.rotation[cut]) - find_angles(truth.rotation[cut])
    angles -= 2.0 * np.pi * np.round(angles / (2.0 * np.pi))
    for i, name in enumerate(("roll", "pitch", "heading")):
        found[name] = np.rad2deg(compute_rms_length(angles[:, i, None]))
    for i, name in enumerate("xyz"):
        found[f"root_{name}"] = compute_rms_length(error[cut, i, None])
    if estimates.root_covariance is not None:
        P = estimates.root_covariance[cut]
        found["nees"] = average_nees(error[cut], P)
        for i, name in enumerate("xyz"):
            found[f"rms_over_p_{name}"] = found[f"root_{name}"] / np.sqrt(P[:, i, i].mean())
    if estimates.attitude_covariance is not None:
        found["nees_attitude"] = average_nees(turned, estimates.attitude_covariance[cut])
    if estimates.nis is not None and np.isfinite(estimates.nis[cut]).any():
        found["nis"] = np.nanmean(estimates.nis[cut])
    if estimates.boom is not None and truth.boom is not None:
        boom = find_boom_error(truth.boom, estimates.boom, judged.settled * truth.step)
        found |= {} if boom is None else {"boom": boom}
    if estimates.latency > 0.0:
        found[WAIT] = estimates.latency
    return {name: float(value) for name, value in found.items()}


def find_turn(true: Array, estimated: Array) -> Array:
    """Return the rotation vectors that turn estimated attitudes (n, 3, 3) into true ones, (n, 3).

    In the body's frame, rad; the errors of attitude in `estimation.inertial.strapdown`.
    """
    if not np.isfinite(estimated).all():
        return np.full((len(true), 3), np.nan)
    return np.asarray(Rotation.from_matrix(estimated.transpose(0, 2, 1) @ true).as_rotvec())
