"""What is measured of estimates: errors of position and velocity, their claims, and their lag.

Names of measures end with the degree of freedom, `contract.DOF`; those without are over all six.
Signals are judged after `record.settling`.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.signals import divide, find_lag
from owtsweep.results.criteria import Criterion
from owtsweep.studies.base.contest import WAIT
from owtsweep.studies.base.schemes import NotFinite
from owtsweep.studies.floater.contract import DOF, Estimates, Truth

#: Criteria of the maps.
_PART = "a hundredth of what moves, or of a report's noise, changes no decision"
CRITERIA = {
    "velocity": Criterion(
        "velocity: rms error over standard deviation, all degrees of freedom", "root", "", 0.01,
        _PART,
    ),
    "position": Criterion(
        "position: rms error over standard deviation, all degrees of freedom", "root", "", 0.01,
        _PART,
    ),
    "worst": Criterion(
        "position: rms error over noise of a report, worst degree of freedom", "root", "", 0.01,
        _PART,
    ),
}  # fmt: skip
#: Further measures -> what they are. Each is there per degree of freedom, and over all but `mse`.
#: NEES and NIS are over their dimension: 1 for a filter that knows its errors.
OTHERS = {
    "mse_position": "mean squared error of the position, m^2 or rad^2",
    "mse_velocity": "mean squared error of the velocity, m^2/s^2 or rad^2/s^2",
    "noise_ratio": "rms error of the position over the noise of a report; over all: `worst`",
    "rms_over_p": "rms error of the position over the root of its mean variance",
    "nees": "normalised squared error of position and velocity",
    "nis": "normalised squared innovation of a report",
    "lag_position": "by what the position comes late, ms; over all: the mean",
    "lag_velocity": "by what the velocity comes late, ms; over all: the mean",
    "relative": "error over the position, 95th percentile, %; over all: the largest",
}
_ENDS = ("", *(f"_{dof}" for dof in DOF))
#: All measures in the order of tables.
MEASURES = (*CRITERIA, WAIT, *(f"{name}{end}" for name in OTHERS for end in _ENDS))
#: In relative errors, a position counts as this part of its rms at least.
FLOOR = 0.1


def compare(truth: Truth, estimates: Estimates, sigma: Array, settled: int) -> dict[str, float]:
    """Compare the estimates of a record with its truth; return measure -> value.

    A degree of freedom that does not move counts in no criterion. `sigma` are the true standard
    deviations of the noise of reported positions, (6,); `settled` is the first sample that is
    judged. Raise `NotFinite` if an estimate is not finite.
    """
    true, true_velocity = truth.position[settled:], truth.velocity[settled:]
    position, velocity = estimates.position[settled:], estimates.velocity[settled:]
    if not (np.isfinite(position).all() and np.isfinite(velocity).all()):
        raise NotFinite("the estimate is not finite")
    error, drift = position - true, velocity - true_velocity
    square, square_velocity = np.mean(error**2, axis=0), np.mean(drift**2, axis=0)
    nees = variance = np.full(len(DOF), np.nan)
    P = estimates.covariance
    if P is not None:
        P = P if len(P) == 1 else P[settled:]
        pp, pv, vv = P[:, :, 0, 0], P[:, :, 0, 1], P[:, :, 1, 1]
        variance = pp.mean(axis=0)
        weighted = vv * error**2 - 2.0 * pv * error * drift + pp * drift**2
        nees = 0.5 * np.mean(divide(weighted, pp * vv - pv**2), axis=0)
    noise_ratio = divide(np.sqrt(square), sigma)
    each = {
        "mse_position": square,
        "mse_velocity": square_velocity,
        "noise_ratio": noise_ratio,
        "rms_over_p": np.sqrt(divide(square, variance)),
        "nees": nees,
        "nis": _average_nis(estimates, settled),
        "lag_position": 1e3 * find_lag(true, position, truth.step, nearest=True),
        "lag_velocity": 1e3 * find_lag(true_velocity, velocity, truth.step, nearest=True),
        "relative": _find_relative(true, error),
    }
    found = {
        "velocity": _root_mean(divide(square_velocity, true_velocity.var(axis=0))),
        "position": _root_mean(divide(square, true.var(axis=0))),
        "worst": _largest(noise_ratio),
        "rms_over_p": _root_mean(each["rms_over_p"] ** 2),
        **{name: _average(each[name]) for name in ("nees", "nis", "lag_position", "lag_velocity")},
        "relative": _largest(each["relative"]),
    }
    for name, values in each.items():
        found |= {f"{name}_{dof}": float(value) for dof, value in zip(DOF, values, strict=True)}
    if estimates.latency > 0.0:
        found[WAIT] = estimates.latency
    return {name: value for name, value in found.items() if not np.isnan(value)}


def _find_relative(truth: Array, error: Array) -> Array:
    """Return the 95th percentile of |error| over |position| with its floor, %, shape (6,)."""
    floor = FLOOR * np.sqrt(np.mean(truth**2, axis=0))
    relative = divide(np.abs(error), np.maximum(np.abs(truth), floor))
    return np.asarray(100.0 * np.percentile(relative, 95.0, axis=0))


def _average_nis(estimates: Estimates, settled: int) -> Array:
    """Return the mean NIS of each degree of freedom, shape (6,), NaN without an innovation."""
    if estimates.nis is None:
        return np.full(len(DOF), np.nan)
    nis = estimates.nis[settled:]
    there = np.isfinite(nis)
    return divide(np.where(there, nis, 0.0).sum(axis=0), there.sum(axis=0).astype(float))


def _average(values: Array) -> float:
    """Return the mean of the numbers among values; NaN if there is none."""
    there = values[~np.isnan(values)]
    return float(there.mean()) if len(there) else float("nan")


def _root_mean(squares: Array) -> float:
    return float(np.sqrt(_average(squares)))


def _largest(values: Array) -> float:
    return float(np.fmax.reduce(values))  # leaves out NaN
