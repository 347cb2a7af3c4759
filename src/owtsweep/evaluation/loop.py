"""Run an estimator as it would run on board: one `update` per step.

The reference engine runs every scheme this way, and every engine a user's scheme without a kernel.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Estimate, Quantity
from owtsweep.evaluation.trajectory import PLANAR_MOTION, Trajectory


class Updating(Protocol):
    """What can be run.

    An estimator may also offer `run_record(inputs, fixes) -> Trajectory`. It takes many steps in
    one call and gives what `update` would give step by step; a fix that did not arrive is NaN.
    """

    def update(self, inputs: Array, fix: Array | None = None, /) -> Any:
        """Take the inputs of a step, and a fix if one arrived; return an `Estimate`."""


def run_estimator(
    estimator: Updating,
    inputs: Array,
    fixes: Array,
    fix_interval: int,
    *,
    judged: Sequence[Quantity] = PLANAR_MOTION,
) -> Trajectory:
    """Run an estimator over a whole record.

    Parameters
    ----------
    inputs
        (steps, i) what is measured at every step. In the hub study: specific force, m/s^2.
    fixes
        (fixes, m) what is measured at steps 0, M, 2 M, ...; NaN if it did not arrive. In the hub
        study: position, m.
    fix_interval
        M, in steps.
    judged
        As for `run_steps`.

    Raises
    ------
    TypeError, ValueError
        As for `run_steps`.
    """
    arrived = np.full((len(inputs), fixes.shape[1]), np.nan)
    arrived[::fix_interval] = fixes
    return run_steps(estimator, np.ascontiguousarray(inputs), arrived, judged=judged)


def run_steps(
    estimator: Updating,
    inputs: Array,
    fixes: Array,
    *,
    first: int = 0,
    judged: Sequence[Quantity] = PLANAR_MOTION,
) -> Trajectory:
    """Run an estimator over the next steps of a record.

    Parameters
    ----------
    inputs, fixes
        (steps, i) and (steps, m), a row per step; a fix that did not arrive is NaN.
    first
        Number of the first of these steps, for messages.
    judged
        The quantities to take from the estimates, in the order in which the state has them.

    Raises
    ------
    TypeError
        If `update` gives something else than an `Estimate`.
    ValueError
        If an estimate has the wrong shape or is not finite, naming the step.
    """
    run_record = getattr(estimator, "run_record", None)
    if run_record is not None:
        trajectory: Trajectory = run_record(inputs, fixes)
    else:
        trajectory = _update_step_by_step(estimator, inputs, fixes, first, judged)
    finite = np.isfinite(trajectory.state).all(axis=1)
    if not np.all(finite):
        raise ValueError(f"the estimate of step {first + int(np.argmin(finite))} is not finite")
    return trajectory


def _update_step_by_step(
    estimator: Updating, inputs: Array, fixes: Array, first: int, judged: Sequence[Quantity]
) -> Trajectory:
    steps, m = fixes.shape
    n = sum(len(quantity.components) for quantity in judged)
    state = np.empty((steps, n))
    covariance: Array | None = None
    innovation: Array | None = None
    innovation_covariance: Array | None = None
    arrived = np.logical_not(np.isnan(fixes).any(axis=1))
    for k in range(steps):
        estimate = estimator.update(inputs[k], fixes[k] if arrived[k] else None)
        if not isinstance(estimate, Estimate):
            raise TypeError(f"update gave a {type(estimate).__name__}, not an owtsweep.Estimate")
        begin = 0
        for quantity in judged:
            value = _take(estimate, quantity, first + k)
            state[k, begin : begin + len(value)] = value
            begin += len(value)
        if estimate.covariance is not None:
            if covariance is None:
                covariance = np.full((steps, n, n), np.nan)
            covariance[k] = estimate.covariance
        if estimate.innovation is not None:
            if innovation is None or innovation_covariance is None:
                innovation = np.full((steps, m), np.nan)
                innovation_covariance = np.full((steps, m, m), np.nan)
            innovation[k] = estimate.innovation.value
            innovation_covariance[k] = estimate.innovation.covariance
    return Trajectory(state, covariance, innovation, innovation_covariance)


def _take(estimate: Estimate, quantity: Quantity, step: int) -> Array:
    value = np.asarray(getattr(estimate, quantity.name), dtype=float)
    size = len(quantity.components)
    if value.shape != (size,):
        raise ValueError(
            f"the {quantity.name} of step {step} has the shape {value.shape}, not ({size},)"
        )
    return value
