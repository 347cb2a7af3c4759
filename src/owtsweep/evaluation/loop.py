"""Running an estimator as it would run on board: one `update` per IMU step.

The reference engine, and every user's scheme without a kernel, runs this way.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Estimate
from owtsweep.studies.hub.contract import Estimator, Sensors
from owtsweep.studies.hub.online.estimator import OnlineEstimator
from owtsweep.studies.hub.sensors import Measurements


class Trajectory(NamedTuple):
    """What an estimator gave over a record.

    state (steps, 4): x, y, v_x, v_y. covariance (steps, 4, 4) or None. innovation (steps, 2) and
    innovation_covariance (steps, 2, 2) with NaN at steps without one, or None.
    """

    state: Array
    covariance: Array | None
    innovation: Array | None
    innovation_covariance: Array | None


def run_estimator(estimator: Estimator, measurements: Measurements, sensors: Sensors) -> Trajectory:
    """Feed a whole record to an estimator; a fix that is NaN did not arrive.

    Raises
    ------
    ValueError
        If an estimate has the wrong shape or is not finite, naming the step.
    """
    if isinstance(estimator, OnlineEstimator):
        return _at_once(estimator, measurements, sensors)
    steps = len(measurements.specific_force)
    state = np.empty((steps, 4))
    covariance: Array | None = None
    innovation: Array | None = None
    innovation_covariance: Array | None = None
    M = sensors.fix_interval
    for k in range(steps):
        fix = measurements.fixes[k // M] if k % M == 0 else None
        if fix is not None and np.isnan(fix).any():
            fix = None
        estimate = estimator.update(measurements.specific_force[k], fix)
        if not isinstance(estimate, Estimate):
            raise TypeError(f"update gave a {type(estimate).__name__}, not an owtsweep.Estimate")
        state[k, :2] = _vector(estimate.position, "position", k)
        state[k, 2:] = _vector(estimate.velocity, "velocity", k)
        if estimate.covariance is not None:
            if covariance is None:
                covariance = np.full((steps, 4, 4), np.nan)
            covariance[k] = estimate.covariance
        if estimate.innovation is not None:
            if innovation is None or innovation_covariance is None:
                innovation = np.full((steps, 2), np.nan)
                innovation_covariance = np.full((steps, 2, 2), np.nan)
            innovation[k] = estimate.innovation.value
            innovation_covariance[k] = estimate.innovation.covariance
    if not np.all(np.isfinite(state)):
        step = int(np.argmax(~np.isfinite(state).all(axis=1)))
        raise ValueError(f"the estimate of step {step} is not finite")
    return Trajectory(state, covariance, innovation, innovation_covariance)


def _at_once(
    estimator: OnlineEstimator, measurements: Measurements, sensors: Sensors
) -> Trajectory:
    """The compiled form takes a record in one call."""
    force = np.ascontiguousarray(measurements.specific_force)
    fixes = np.full_like(force, np.nan)
    fixes[:: sensors.fix_interval] = measurements.fixes
    out = estimator.run(force, fixes)
    if not np.all(np.isfinite(out.state)):
        step = int(np.argmax(~np.isfinite(out.state).all(axis=1)))
        raise ValueError(f"the estimate of step {step} is not finite")
    return Trajectory(
        out.state,
        np.kron(out.covariance, np.eye(2)),
        out.innovation,
        out.innovation_variance[:, None, None] * np.eye(2),
    )


def _vector(value: Array, name: str, step: int) -> Array:
    array = np.asarray(value, dtype=float)
    if array.shape != (2,):
        raise ValueError(f"the {name} of step {step} has the shape {array.shape}, not (2,)")
    return array
