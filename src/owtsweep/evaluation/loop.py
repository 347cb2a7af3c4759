"""Run an estimator as it would run on board: one `update` per step.

Some quantities, the inputs, are measured at every step. Others are measured only now and then; such
a measurement is called a fix, as a position from GNSS beside the accelerations of an IMU.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Protocol

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.collecting import collect
from owtsweep.evaluation.estimate import PLANAR_MOTION, Quantity
from owtsweep.evaluation.trajectory import Trajectory


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
        (steps, i) what is measured at every step.
    fixes
        (fixes, m) what is measured at steps 0, M, 2 M, ...; NaN if it did not arrive.
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
        If an estimate lacks a quantity, has the wrong shape or is not finite, naming the step.
    """
    run_record = getattr(estimator, "run_record", None)
    if run_record is not None:
        trajectory: Trajectory = run_record(inputs, fixes)
    else:
        estimates = _update_step_by_step(estimator, inputs, fixes)
        trajectory = collect(estimates, judged, len(inputs), first)
    finite = np.isfinite(trajectory.state).all(axis=1)
    if not np.all(finite):
        raise ValueError(f"the estimate of step {first + int(np.argmin(finite))} is not finite")
    return trajectory


def _update_step_by_step(estimator: Updating, inputs: Array, fixes: Array) -> Iterator[Any]:
    arrived = np.logical_not(np.isnan(fixes).any(axis=1))
    for k, sample in enumerate(inputs):
        yield estimator.update(sample, fixes[k] if arrived[k] else None)
