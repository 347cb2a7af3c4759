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
    """Return measurements as an array of floats, after checks.

    Raises
    ------
    InputError
        If the shape is not (series, steps, m), a number is infinite (a lost component is NaN), or
        the model has fewer steps than the measurements.
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
    """Check that a record is not longer than a model whose matrices depend on time.

    Raises
    ------
    InputError
        If the record has more steps than the model.
    """
    if model.steps is not None and model.steps < steps:
        raise InputError(
            f"measurements: {steps} steps are more than the {model.steps} of the model; give "
            "matrices for all of them, or matrices without an axis of time"
        )


def check_prior(model: LinearModel, covariance: Array) -> Array:
    """Return the covariance of the first state as an array of floats, after checks.

    Raises
    ------
    InputError
        If the shape is not (n, n), or the matrix is not a covariance.
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
    """Return the expected first state of each series, shape (series, n).

    Raises
    ------
    InputError
        If the shape of `state` is neither (n,) nor (series, n).
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
    """Compute the effects B u of the inputs u on the state, shape (series, steps, n).

    The effects are zero if the model has no B.

    Raises
    ------
    InputError
        If the model has B and inputs are missing, of a wrong shape or not finite, or if the model
        has no B and there are inputs.
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
    """Find the distinct rows of marks (series, ...), and for each series the index of its row.

    A series' marks say, for example, which measurements exist. The rows have the shape
    (patterns, ...), the indices (series,).
    """
    flat = marks.reshape(len(marks), -1)
    if np.all(flat == flat[:1]):  # the common case, without sorting
        return marks[:1], np.zeros(len(marks), dtype=np.int64)
    _, first, pattern = np.unique(flat, axis=0, return_index=True, return_inverse=True)
    return marks[first], pattern.reshape(-1)


def share_out(values: NDArray[T], pattern: NDArray[np.int64]) -> NDArray[T]:
    """Return each series' entry of values (patterns, ...), shape (series, ...).

    `pattern` is the index of each series' entry. If there is only one pattern, the values are
    returned as they are, shape (1, ...).
    """
    return values if len(values) == 1 else values[pattern]
