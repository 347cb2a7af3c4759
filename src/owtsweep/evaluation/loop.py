"""Run an estimator as it would run on board: one `update` per IMU step.

The reference engine runs every scheme this way, and every engine a user's scheme without a kernel.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Protocol

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.collecting import collect
from owtsweep.evaluation.estimate import PLANAR_MOTION
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
        estimates = _update_one_by_one(estimator, specific_force, positions)
        trajectory = collect(estimates, PLANAR_MOTION, len(specific_force), first)
    finite = np.isfinite(trajectory.state).all(axis=1)
    if not np.all(finite):
        raise ValueError(f"the estimate of step {first + int(np.argmin(finite))} is not finite")
    return trajectory


def _update_one_by_one(
    estimator: Updating, specific_force: Array, positions: Array
) -> Iterator[Any]:
    arrived = np.logical_not(np.isnan(positions).any(axis=1))
    for k, force in enumerate(specific_force):
        yield estimator.update(force, positions[k] if arrived[k] else None)
