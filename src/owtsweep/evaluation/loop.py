"""Run an estimator as it would run on board: one `update` per IMU step.

The reference engine runs every scheme this way, and every engine a user's scheme without a kernel.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Estimate
from owtsweep.evaluation.trajectory import Trajectory


class Updating(Protocol):
    """What can be run.

    An estimator may also offer `run_record(specific_force, positions) -> Trajectory`, which takes
    many steps in one call and gives what `update` would give one by one.
    """

    def update(self, specific_force: Array, position: Array | None = None) -> Any:
        """Take one sample and perhaps a fix; return an `Estimate`."""


def run_estimator(
    estimator: Updating, specific_force: Array, fixes: Array, fix_interval: int
) -> Trajectory:
    """Run an estimator over a whole record.

    Parameters
    ----------
    specific_force
        (steps, 2) in the IMU's frame, m/s^2.
    fixes
        (fixes, 2) in NED, m, at steps 0, M, 2 M, ...; a fix that is NaN did not arrive.
    fix_interval
        M, in steps.

    Raises
    ------
    TypeError, ValueError
        As for `run_steps`.
    """
    positions = np.full((len(specific_force), 2), np.nan)
    positions[::fix_interval] = fixes
    return run_steps(estimator, np.ascontiguousarray(specific_force), positions)


def run_steps(
    estimator: Updating, specific_force: Array, positions: Array, *, first: int = 0
) -> Trajectory:
    """Run an estimator over the next steps of a record.

    Parameters
    ----------
    specific_force, positions
        (steps, 2) in m/s^2 and m; NaN in a position where no fix arrived.
    first
        Number of the first of these steps, for messages.

    Raises
    ------
    TypeError
        If `update` gives something else than an `Estimate`.
    ValueError
        If an estimate has the wrong shape or is not finite, naming the step.
    """
    run_record = getattr(estimator, "run_record", None)
    if run_record is not None:
        trajectory: Trajectory = run_record(specific_force, positions)
    else:
        trajectory = _update_one_by_one(estimator, specific_force, positions, first)
    finite = np.isfinite(trajectory.state).all(axis=1)
    if not np.all(finite):
        raise ValueError(f"the estimate of step {first + int(np.argmin(finite))} is not finite")
    return trajectory


def _update_one_by_one(
    estimator: Updating, specific_force: Array, positions: Array, first: int
) -> Trajectory:
    steps = len(specific_force)
    state = np.empty((steps, 4))
    covariance: Array | None = None
    innovation: Array | None = None
    innovation_covariance: Array | None = None
    arrived = np.logical_not(np.isnan(positions).any(axis=1))
    for k in range(steps):
        estimate = estimator.update(specific_force[k], positions[k] if arrived[k] else None)
        if not isinstance(estimate, Estimate):
            raise TypeError(f"update gave a {type(estimate).__name__}, not an owtsweep.Estimate")
        state[k, :2] = _vector(estimate.position, "position", first + k)
        state[k, 2:] = _vector(estimate.velocity, "velocity", first + k)
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
    return Trajectory(state, covariance, innovation, innovation_covariance)


def _vector(value: Array, name: str, step: int) -> Array:
    array = np.asarray(value, dtype=float)
    if array.shape != (2,):
        raise ValueError(f"the {name} of step {step} has the shape {array.shape}, not (2,)")
    return array
