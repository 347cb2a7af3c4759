"""Runs an estimator as on board: one `update` per step.

Some quantities, the inputs, are measured at every step, such as the accelerations of an IMU. Others
are measured less often; such a measurement is called a fix, for example a position from GNSS.
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
    """An estimator that can be run step by step.

    An estimator may also offer `run_record(inputs, fixes) -> Trajectory`. It takes many steps in
    one call and returns the same estimates as `update` step by step; a fix that did not arrive is
    NaN.
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
        (steps, i): the measurements of every step.
    fixes
        (fixes, m): the fixes at steps 0, M, 2 M, ...; NaN if a fix did not arrive.
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
        (steps, i) and (steps, m), one row per step; a fix that did not arrive is NaN.
    first
        Number of the first of these steps, for error messages.
    judged
        The quantities to take from the estimates, in their order in the state.

    Raises
    ------
    TypeError
        If `update` does not return an `Estimate`.
    ValueError
        If an estimate lacks a quantity, has the wrong shape or is not finite. The message names the
        step.
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
