"""Gains that repeat: if measurements come in a fixed cycle, so do the gains after a transient.

With a model that does not change and a fixed cycle (one sensor slower than another, for example)
the covariance converges to a periodic one (Anderson and Moore 1979, section 4.4, for a cycle of one
step). The transient and one cycle then serve records of any length.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.estimation.filter_data import check_prior
from owtsweep.estimation.kalman import Gains
from owtsweep.estimation.kalman_step import correct_covariance, predict_covariance
from owtsweep.estimation.linear import LinearModel

#: Distance from the periodic covariance, relative to the states' variances, that is negligible.
TOLERANCE = 1e-13


def schedule_gains(
    model: LinearModel, covariance: Array, available: NDArray[np.bool_], steps: int
) -> Gains:
    """Gains of one pattern of losses that repeats, for `kalman.apply_gains`.

    Parameters
    ----------
    model
        The model, with matrices that have no axis of time.
    covariance
        (n, n) of the state of step 0 before its measurement.
    available
        (cycle, m): whether a component of the measurement exists, over one cycle.
    steps
        Length of the longest record. If the covariance has not settled by then, every step has its
        own row. (The covariance of a state that nothing observes never settles.)

    Raises
    ------
    InputError
        If the model changes with time, or the pattern does not fit it.
    """
    there = np.asarray(available, dtype=bool)
    if model.steps is not None:
        raise InputError("model: changes with time; a schedule needs one without an axis of time")
    if there.ndim != 2 or len(there) == 0 or there.shape[1] != model.measurements:
        raise InputError(
            f"available: has the shape {there.shape}; give (cycle, {model.measurements})"
        )
    F, Q, H, R, _ = model.at(0)
    P = check_prior(model, covariance)[None]
    rows: list[tuple[Array, Array, Array, Array]] = []
    change, settled = np.inf, False
    while not settled and len(rows) < steps:
        first = P
        for now in there:
            K, S, filtered = correct_covariance(P, H, R, now[None])
            rows.append((K, S, P, filtered))
            P = predict_covariance(filtered, F, Q)
        before, change = change, _change(first[0], P[0])
        settled = _is_settled(before, change)
    K, S, predicted, filtered = (np.stack(column, axis=1) for column in zip(*rows, strict=True))
    repeated = np.tile(there, (len(rows) // len(there), 1))[None]
    cycle = len(there) if settled else 0
    return Gains(repeated, K, S, predicted, filtered, cycle)


def _change(before: Array, after: Array) -> float:
    """Largest change of a covariance, relative to the variances of the two states concerned."""
    scale = np.sqrt(np.diagonal(after))
    scale = np.where(scale > 0.0, scale, 1.0)
    return float(np.max(np.abs(after - before) / np.outer(scale, scale)))


def _is_settled(before: float, change: float) -> bool:
    """Whether all changes still to come are within the tolerance.

    While changes fall by the factor r = change / before per cycle, those to come sum to
    change r / (1 - r). Changes that no longer fall are round-off.
    """
    if change > TOLERANCE:
        return False
    return change >= before or change * change <= TOLERANCE * (before - change)
