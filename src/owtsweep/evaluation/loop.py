"""Run an estimator as on board a ship: one call of its method `update` per step.

What is measured at every step, such as the accelerations of an IMU, is called inputs. A measurement
that comes less often, such as a position from GNSS, is called a fix.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable
from typing import Protocol

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Estimate
from owtsweep.evaluation.trajectory import Trajectory


class Updating(Protocol):
    """The interface of an estimator that can be run step by step."""

    @abstractmethod
    def update(self, inputs: Array, fix: Array | None = None, /) -> object:
        """Take the inputs of a step, and its fix if any; return an `Estimate` of the state."""


class RecordEstimator(Updating, ABC):
    """The base class of an estimator that can also take many steps in one call."""

    @abstractmethod
    def run_record(self, inputs: Array, fixes: Array, /) -> Trajectory:
        """Take many steps, one row each; return the estimates that `update` would give.

        The row of `fixes` is NaN at steps without a fix.
        """


def run_estimator(
    estimator: Updating, inputs: Array, fixes: Array, fix_interval: int
) -> Trajectory:
    """Run an estimator over a whole record, and return the estimates of all steps.

    Raise `TypeError` if `update` does not return an `Estimate`, or `run_record` no `Trajectory`.
    Raise `ValueError` if an estimate lacks position or velocity, has the wrong shape or is not
    finite.

    `estimator`: the estimator, before its first step. `inputs`, `fixes`: shape (steps, i), and
    shape (fixes, m); fix j belongs to step j * fix_interval, and is NaN if it did not arrive.
    """
    arrived = np.full((len(inputs), fixes.shape[1]), np.nan)
    arrived[::fix_interval] = fixes
    return run_steps(estimator, np.ascontiguousarray(inputs), arrived)


def run_steps(estimator: Updating, inputs: Array, fixes: Array, *, first: int = 0) -> Trajectory:
    """Run an estimator over the next steps of a record, and return the estimates of these steps.

    The method `run_record` of a `RecordEstimator` is called once for all steps. Of others, the
    method `update` is called at each step. Errors are those of `run_estimator`; the message names
    the step where it is known.

    estimator: the estimator, which has taken all earlier steps of the record.
    inputs, fixes: shape (steps, i), and shape (steps, m), NaN at steps without a fix.
    first: Number of the first of these steps in the record, for error messages.
    """
    if isinstance(estimator, RecordEstimator):
        trajectory = estimator.run_record(inputs, fixes)
        _check_trajectory(trajectory, len(inputs))
    else:
        arrived = np.logical_not(np.isnan(fixes).any(axis=1))
        steps = zip(inputs, fixes, arrived, strict=True)
        estimates = (estimator.update(at, fix if there else None) for at, fix, there in steps)
        trajectory = collect(estimates, len(inputs), first)
    finite = np.isfinite(trajectory.state).all(axis=1)
    if not np.all(finite):
        raise ValueError(f"the estimate of step {first + int(np.argmin(finite))} is not finite")
    return trajectory


def collect(estimates: Iterable[object], steps: int, first: int = 0) -> Trajectory:
    """Collect the `Estimate`s of steps from `first` on into a trajectory.

    Raise `TypeError` if an item of `estimates` is not an `Estimate`. Raise `ValueError` if an
    estimate lacks position or velocity, or if one of them, a covariance or an innovation has the
    wrong shape or does not consist of real numbers. The message names the step.
    """
    state = np.empty((steps, 4))
    covariance: Array | None = None
    innovations: tuple[Array, Array] | None = None  # with their covariances
    for k, estimate in enumerate(estimates):
        if not isinstance(estimate, Estimate):
            raise TypeError(f"update gave a {type(estimate).__name__}, not an owtsweep.Estimate")
        for name, part in (("position", slice(2)), ("velocity", slice(2, 4))):
            if name not in estimate.quantities:
                raise ValueError(f"the estimate of step {first + k} has no {name}")
            state[k, part] = _check_array(estimate.quantities[name], (2,), name, first + k)
        if estimate.covariance is not None:
            if covariance is None:
                covariance = np.full((steps, 4, 4), np.nan)
            covariance[k] = _check_array(estimate.covariance, (4, 4), "covariance", first + k)
        if estimate.innovation is not None:
            value, weight = estimate.innovation.value, estimate.innovation.covariance
            if innovations is None:
                m = len(value)
                innovations = np.full((steps, m), np.nan), np.full((steps, m, m), np.nan)
            m = innovations[0].shape[1]
            innovations[0][k] = _check_array(value, (m,), "innovation", first + k)
            innovations[1][k] = _check_array(weight, (m, m), "innovation's covariance", first + k)
    return Trajectory(state, covariance, *(innovations or ()))


def _check_array(value: object, shape: tuple[int, ...], what: str, step: int) -> Array:
    """Return a value as an array of real numbers of this shape, or raise `ValueError`.

    NumPy would broadcast another shape silently.
    """
    array = np.asarray(value)
    if array.shape != shape:
        raise ValueError(f"the {what} of step {step} has the shape {array.shape}, not {shape}")
    if array.dtype.kind not in "fiubO":
        raise ValueError(f"the {what} of step {step} holds {array.dtype}, not real numbers")
    return array.astype(float, copy=False)


def _check_trajectory(trajectory: Trajectory, steps: int) -> None:
    """Raise `TypeError` or `ValueError` unless `run_record` gave floats (steps, 4)."""
    if not isinstance(trajectory, Trajectory):
        raise TypeError(f"run_record gave a {type(trajectory).__name__}, not a Trajectory")
    state = np.asarray(trajectory.state)
    if state.shape != (steps, 4) or state.dtype.kind != "f":
        raise ValueError(
            f"run_record gave states of {state.dtype} and the shape {state.shape}, not numbers of "
            f"the shape ({steps}, 4)"
        )
