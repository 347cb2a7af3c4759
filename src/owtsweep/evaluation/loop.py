"""Run an estimator as on board a ship: one call of its method `update` per step.

Quantities that are measured at every step, such as the accelerations of an IMU, are called inputs.
A measurement that comes less often, such as a position from GNSS, is called a fix.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from typing import Protocol

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import PLANAR_MOTION, Estimate, Quantity
from owtsweep.evaluation.trajectory import Trajectory


class Updating(Protocol):
    """The interface of an estimator that can be run step by step."""

    def update(self, inputs: Array, fix: Array | None = None, /) -> object:
        """Take the measurements of a step, and return an `Estimate` of the present state.

        `inputs` are the quantities measured at every step, such as accelerations. `fix` is a
        measurement that does not come at every step, such as a position from GNSS; None if this
        step has no fix.
        """


class RecordEstimator(ABC):
    """The base class of an estimator that can also take many steps in one call."""

    @abstractmethod
    def update(self, inputs: Array, fix: Array | None = None, /) -> object:
        """Take the measurements of a step, as `Updating.update`."""

    @abstractmethod
    def run_record(self, inputs: Array, fixes: Array, /) -> Trajectory:
        """Take the measurements of many steps; return the estimates that `update` would give.

        Both have one row per step; the row of `fixes` is NaN at steps without a fix.
        """


def run_estimator(
    estimator: Updating,
    inputs: Array,
    fixes: Array,
    fix_interval: int,
    *,
    judged: Sequence[Quantity] = PLANAR_MOTION,
) -> Trajectory:
    """Run an estimator over a whole record, and return the estimates of all steps.

    Parameters
    ----------
    estimator
        The estimator, before its first step.
    inputs
        The quantities measured at every step, such as accelerations, shape (steps, i).
    fixes
        The measurements that come less often, such as positions from GNSS, shape (fixes, m). Row j
        belongs to step j * fix_interval. A row is NaN if its measurement did not arrive.
    fix_interval
        Number of steps from one fix to the next.
    judged
        The quantities to take from the estimates, in the order of the result's columns.

    Raises
    ------
    TypeError
        If `update` does not return an `Estimate`, or `run_record` no `Trajectory`.
    ValueError
        If an estimate lacks a quantity, has the wrong shape or is not finite.
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
    """Run an estimator over the next steps of a record, and return the estimates of these steps.

    The method `run_record` of a `RecordEstimator` is called once for all steps. Of others, the
    method `update` is called at each step.

    Parameters
    ----------
    estimator
        The estimator, which has taken all earlier steps of the record.
    inputs
        The quantities measured at every step, such as accelerations, shape (steps, i).
    fixes
        The measurements that come less often, such as positions from GNSS, shape (steps, m); NaN at
        steps without such a measurement.
    first
        Number of the first of these steps in the record, for error messages.
    judged
        The quantities to take from the estimates, in the order of the result's columns.

    Raises
    ------
    TypeError
        If `update` does not return an `Estimate`, or `run_record` no `Trajectory`.
    ValueError
        If an estimate lacks a quantity, has the wrong shape or is not finite. The message about an
        estimate of `update`, or about one that is not finite, names the step.
    """
    if isinstance(estimator, RecordEstimator):
        trajectory = estimator.run_record(inputs, fixes)
        _check_trajectory(trajectory, len(inputs), sum(len(each.components) for each in judged))
    else:
        estimates = _update_step_by_step(estimator, inputs, fixes)
        trajectory = collect(estimates, judged, len(inputs), first)
    finite = np.isfinite(trajectory.state).all(axis=1)
    if not np.all(finite):
        raise ValueError(f"the estimate of step {first + int(np.argmin(finite))} is not finite")
    return trajectory


def _update_step_by_step(estimator: Updating, inputs: Array, fixes: Array) -> Iterator[object]:
    arrived = np.logical_not(np.isnan(fixes).any(axis=1))
    for k, sample in enumerate(inputs):
        yield estimator.update(sample, fixes[k] if arrived[k] else None)


def collect(
    estimates: Iterable[object], judged: Sequence[Quantity], steps: int, first: int = 0
) -> Trajectory:
    """Collect the estimates of some steps into a trajectory.

    Parameters
    ----------
    estimates
        One `Estimate` per step.
    judged
        The quantities to take from the estimates, in the order of the result's columns.
    steps
        Number of estimates.
    first
        Number of the first of these steps in the record, for error messages.

    Raises
    ------
    TypeError
        If an item of `estimates` is not an `Estimate`.
    ValueError
        If an estimate lacks a quantity, or a quantity, covariance or innovation has the wrong shape
        or does not consist of real numbers. The message names the step.
    """
    size = sum(len(quantity.components) for quantity in judged)
    state = np.empty((steps, size))
    covariance: Array | None = None
    innovation: Array | None = None
    innovation_covariance: Array | None = None
    for k, estimate in enumerate(estimates):
        if not isinstance(estimate, Estimate):
            raise TypeError(f"update gave a {type(estimate).__name__}, not an owtsweep.Estimate")
        start = 0
        for name, components in judged:
            stop = start + len(components)
            state[k, start:stop] = _check_quantity(estimate, name, len(components), first + k)
            start = stop
        if estimate.covariance is not None:
            if covariance is None:
                covariance = np.full((steps, size, size), np.nan)
            covariance[k] = _check_array(estimate.covariance, (size, size), "covariance", first + k)
        if estimate.innovation is not None:
            value, weight = estimate.innovation.value, estimate.innovation.covariance
            if innovation is None or innovation_covariance is None:
                m = len(value)
                innovation = np.full((steps, m), np.nan)
                innovation_covariance = np.full((steps, m, m), np.nan)
            m = innovation.shape[1]
            innovation[k] = _check_array(value, (m,), "innovation", first + k)
            innovation_covariance[k] = _check_array(
                weight, (m, m), "innovation's covariance", first + k
            )
    return Trajectory(state, covariance, innovation, innovation_covariance)


def _check_quantity(estimate: Estimate, name: str, size: int, step: int) -> Array:
    """Return the quantity `name` of an estimate as an array (size,), after checks.

    Raises
    ------
    ValueError
        If the estimate lacks the quantity, or the quantity has another shape or does not consist of
        real numbers. The message names the step.
    """
    if name not in estimate.quantities:
        raise ValueError(f"the estimate of step {step} has no {name}")
    return _check_array(estimate.quantities[name], (size,), name, step)


def _check_array(value: object, shape: tuple[int, ...], what: str, step: int) -> Array:
    """Return a value as an array of real numbers, after a check of its shape.

    Without this check NumPy would broadcast another shape silently.

    Parameters
    ----------
    value
        What the estimator gave.
    shape
        The shape that `value` must have.
    what, step
        The name of the value, and the number of the step, for error messages.

    Raises
    ------
    ValueError
        If the shape is another, or `value` does not consist of real numbers.
    """
    array = np.asarray(value)
    if array.shape != shape:
        raise ValueError(f"the {what} of step {step} has the shape {array.shape}, not {shape}")
    if array.dtype.kind not in "fiubO":
        raise ValueError(f"the {what} of step {step} holds {array.dtype}, not real numbers")
    return array.astype(float, copy=False)


def _check_trajectory(trajectory: Trajectory, steps: int, size: int) -> None:
    """Check what an estimator's method `run_record` has returned.

    Raises
    ------
    TypeError
        If `trajectory` is not a `Trajectory`.
    ValueError
        If the state of the trajectory is not an array of floats of the shape (steps, size).
    """
    if not isinstance(trajectory, Trajectory):
        raise TypeError(f"run_record gave a {type(trajectory).__name__}, not a Trajectory")
    state = np.asarray(trajectory.state)
    if state.shape != (steps, size) or state.dtype.kind != "f":
        raise ValueError(
            f"run_record gave states of {state.dtype} and the shape {state.shape}, not numbers of "
            f"the shape ({steps}, {size})"
        )
