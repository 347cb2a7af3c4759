"""Checks a filter's input, and groups series that lost the same measurements."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.estimation.kalman_step import multiply
from owtsweep.estimation.linear import LinearModel, check_covariance

T = TypeVar("T", bound=np.generic)


def check_measurements(model: LinearModel, measurements: Array) -> Array:
    """Measurements as (series, steps, m) numbers, NaN where a component was lost.

    Raises
    ------
    InputError
        If the shape is wrong, a number is infinite, or the model has fewer steps.
    """
    z = np.asarray(measurements, dtype=float)
    if z.ndim != 3 or z.shape[-1] != model.measurements:
        raise InputError(
            f"measurements: have the shape {z.shape}; give (series, steps, {model.measurements})"
        )
    if np.any(np.isinf(z)):
        raise InputError("measurements: some are infinite; mark what was lost by NaN")
    check_steps(model, z.shape[1])
    return z


def check_steps(model: LinearModel, steps: int) -> None:
    """Refuse a record that is longer than the model.

    Raises
    ------
    InputError
        If it has more steps.
    """
    if model.steps is not None and model.steps < steps:
        raise InputError(
            f"measurements: {steps} steps are more than the {model.steps} of the model; give "
            "matrices for all of them, or matrices without an axis of time"
        )


def check_prior(model: LinearModel, covariance: Array) -> Array:
    """The covariance of the first state as (n, n) numbers.

    Raises
    ------
    InputError
        If the shape is wrong, or it is not a covariance.
    """
    P = np.asarray(covariance, dtype=float)
    if P.shape != (model.states, model.states):
        raise InputError(
            f"covariance: has the shape {P.shape}; {model.states} states need "
            f"{(model.states, model.states)}"
        )
    check_covariance("covariance", P)
    return P


def spread_state(model: LinearModel, state: Array, series: int) -> Array:
    """The expected first state of each series, (series, n).

    Raises
    ------
    InputError
        If it is neither (n,) nor (series, n).
    """
    x = np.asarray(state, dtype=float)
    if x.shape not in ((model.states,), (series, model.states)):
        raise InputError(
            f"state: has the shape {x.shape}; give ({model.states},), or one per series"
        )
    return np.array(np.broadcast_to(x, (series, model.states)))


def compute_input_effects(
    model: LinearModel, inputs: Array | None, series: int, steps: int
) -> Array:
    """B u of every step, (series, steps, n); zeros where the model has no B.

    Raises
    ------
    InputError
        If inputs are missing, given without B, of a wrong shape or not finite.
    """
    shape = (series, steps, model.states)
    if model.B is None:
        if inputs is not None:
            raise InputError("inputs: the model has no B; give it one, or leave the inputs out")
        return np.broadcast_to(0.0, shape)
    expected = (steps, model.B.shape[-1])
    if inputs is None:
        raise InputError(f"inputs: the model has B, so it needs them; give {expected}")
    u = np.asarray(inputs, dtype=float)
    if u.shape not in (expected, (series, *expected)):
        raise InputError(f"inputs: have the shape {u.shape}; give {expected}, or one per series")
    if not np.all(np.isfinite(u)):
        raise InputError("inputs: not all are finite; fill what is missing")
    B = model.B if model.B.ndim == 2 else model.B[:steps]
    return np.broadcast_to(multiply(B, u), shape)


def find_patterns(marks: NDArray[Any]) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """The different rows of (series, ...) marks, and for each series the number of its row."""
    flat = marks.reshape(len(marks), -1)
    if np.all(flat == flat[:1]):  # the common case, without sorting
        return marks[:1], np.zeros(len(marks), dtype=np.int64)
    _, first, pattern = np.unique(flat, axis=0, return_index=True, return_inverse=True)
    return marks[first], pattern.reshape(-1)


def share_out(values: NDArray[T], pattern: NDArray[np.int64]) -> NDArray[T]:
    """Each series' entry of (patterns, ...); (1, ...) if all series share one pattern."""
    return values if len(values) == 1 else values[pattern]
