"""Check the input of a filter, and group the series that lost the same measurements."""

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

    Parameters
    ----------
    model
        The model, whose measurements have m components.
    measurements
        Shape (series, steps, m); NaN where a component was lost.

    Raises
    ------
    InputError
        If the shape is another, a number is infinite, or the model's matrices depend on time and
        are given for fewer steps.
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
    """Check that a model has matrices for all steps of a record.

    Raises
    ------
    InputError
        If the model's matrices depend on time and are given for fewer than `steps` steps.
    """
    if model.steps is not None and model.steps < steps:
        raise InputError(
            f"measurements: {steps} steps are more than the {model.steps} of the model; give "
            "matrices for all of them, or matrices without an axis of time"
        )


def check_prior(model: LinearModel, covariance: Array) -> Array:
    """Return the covariance of the state at step 0 as an array of floats, after checks.

    Raises
    ------
    InputError
        If the shape of `covariance` is not (n, n), where n is the model's number of states, or the
        matrix is not symmetric and positive semidefinite.
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
    """Return the expected state of each series at step 0, shape (series, n).

    Parameters
    ----------
    model
        The model, with n states.
    state
        Expected state of all series, shape (n,), or of each series, shape (series, n).
    series
        Number of series.

    Raises
    ------
    InputError
        If the shape of `state` is neither (n,) nor (series, n).
    """
    x = np.asarray(state, dtype=float)
    if x.shape not in ((model.states,), (series, model.states)):
        raise InputError(
            f"state: has the shape {x.shape}; give ({model.states},) or {(series, model.states)}"
        )
    return np.array(np.broadcast_to(x, (series, model.states)))


def compute_input_effects(
    model: LinearModel, inputs: Array | None, series: int, steps: int
) -> Array:
    """Compute the effects B u of the inputs u on the n states, shape (series, steps, n).

    The effects are zero if the model has no input matrix B.

    Parameters
    ----------
    model
        The model.
    inputs
        Shape (steps, p) or (series, steps, p); None if the model has no B.
    series, steps
        Number of series, and of steps of each series.

    Raises
    ------
    InputError
        If the model has B, and `inputs` is None, of a wrong shape or not finite; or if the model
        has no B, and `inputs` is not None.
    """
    shape = (series, steps, model.states)
    if model.B is None:
        if inputs is not None:
            raise InputError("inputs: the model has no B; give it one, or leave the inputs out")
        return np.broadcast_to(0.0, shape)
    expected = (steps, model.B.shape[-1])
    if inputs is None:
        raise InputError(f"inputs: a model with B needs inputs; give the shape {expected}")
    u = np.asarray(inputs, dtype=float)
    if u.shape not in (expected, (series, *expected)):
        raise InputError(
            f"inputs: have the shape {u.shape}; give {expected} or {(series, *expected)}"
        )
    if not np.all(np.isfinite(u)):
        raise InputError("inputs: not all are finite; replace NaN and infinite numbers")
    B = model.B if model.B.ndim == 2 else model.B[:steps]
    return np.broadcast_to(multiply(B, u), shape)


def find_patterns(marks: NDArray[Any]) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """Group series with equal marks; the marks say, for example, which measurements exist.

    Parameters
    ----------
    marks
        The marks of each series, shape (series, ...).

    Returns
    -------
    patterns
        The distinct entries of `marks`, shape (patterns, ...).
    pattern
        For each series, the index of its entry in `patterns`, shape (series,).
    """
    flat = marks.reshape(len(marks), -1)
    if np.all(flat == flat[:1]):  # the common case, without sorting
        return marks[:1], np.zeros(len(marks), dtype=np.int64)
    _, first, pattern = np.unique(flat, axis=0, return_index=True, return_inverse=True)
    return marks[first], pattern.reshape(-1)


def share_out(values: NDArray[T], pattern: NDArray[np.int64]) -> NDArray[T]:
    """Return for each series the values of its pattern, shape (series, ...).

    Series for which the same measurements exist have one pattern, and share values.

    Parameters
    ----------
    values
        One entry per pattern of series, shape (patterns, ...). If there is only one pattern,
        `values` is returned unchanged; its shape (1, ...) broadcasts to all series.
    pattern
        For each series, the index of its pattern, shape (series,).
    """
    return values if len(values) == 1 else values[pattern]
