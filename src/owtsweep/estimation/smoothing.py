"""Smooth: estimate the state of each step from later measurements too.

Rauch, Tung and Striebel (1965): with C[k] = P[k|k] F' P[k+1|k]^-1,

    x[k|N] = x[k|k] + C[k] (x[k+1|N] - x[k+1|k])
    P[k|N] = P[k|k] + C[k] (P[k+1|N] - P[k+1|k]) C[k]'

(Anderson and Moore 1979, section 7.4). A smoother goes backwards over the results of a filter. The
smoother does not use the measurements again, so lost measurements need no special treatment here.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.estimation.filter_data import share_out
from owtsweep.estimation.kalman import Filtered, Gains
from owtsweep.estimation.kalman_step import multiply, transpose
from owtsweep.estimation.linear import LinearModel

#: Eigenvalues of a correlation matrix below this are round-off: directions that are known exactly.
KNOWN_EXACTLY = 1e-14


class Smoothed(NamedTuple):
    """The smoothed states, and the covariances of their errors.

    `state` has the shape (series, steps, n), `covariance` (series, steps, n, n), for n states.
    """

    state: Array
    covariance: Array


def smooth(run: Filtered) -> Smoothed:
    """Estimate the state of every step from all measurements of a series, earlier and later.

    `run` holds the results of a Kalman filter for several series.
    """
    gains, (series, steps, n) = run.gains, run.filtered.shape
    rows = gains.rows_of(steps)
    C_of_rows = compute_smoother_gains(run.model, gains)
    x, P = run.filtered.copy(), gains.filtered[:, rows]
    for k in range(steps - 2, -1, -1):
        C = C_of_rows[:, rows[k]]
        x[:, k] += multiply(share_out(C, run.pattern), x[:, k + 1] - run.predicted[:, k + 1])
        P[:, k] += C @ (P[:, k + 1] - gains.predicted[:, rows[k + 1]]) @ transpose(C)
    return Smoothed(x, np.broadcast_to(share_out(P, run.pattern), (series, steps, n, n)))


def smooth_fixed_lag(run: Filtered, lag: int) -> Smoothed:
    """Estimate the state of each step k from the measurements up to step k + lag.

    The last `lag` steps use the measurements up to the record's end. For each step k, a smoother
    of Rauch, Tung and Striebel goes from step k + lag back to step k; all these passes are computed
    side by side. The result is the optimal estimate from these measurements. (filterpy's
    FixedLagSmoother does not compute the optimal estimate.)

    Parameters
    ----------
    run
        The results of a Kalman filter over several series.
    lag
        Lag in steps, at least 0. With 0, the filter's estimates are returned.

    Raises
    ------
    InputError
        If the lag is negative.
    """
    if lag < 0:
        raise InputError(f"lag: {lag} steps; give 0 or more")
    gains, (series, steps, n) = run.gains, run.filtered.shape
    rows, last = gains.rows_of(steps), steps - 1
    C_of_rows = compute_smoother_gains(run.model, gains)
    newest = np.minimum(np.arange(steps) + lag, last)
    x, P = run.filtered[:, newest], gains.filtered[:, rows[newest]]
    for back in range(min(lag, last) - 1, -1, -1):  # from step k + back + 1 to step k + back
        windows = slice(last - back)  # the other windows end with the record: they are shorter
        at = np.arange(last - back) + back
        C = C_of_rows[:, rows[at]]
        ahead = x[:, windows] - run.predicted[:, at + 1]
        x[:, windows] = run.filtered[:, at] + multiply(share_out(C, run.pattern), ahead)
        wider = P[:, windows] - gains.predicted[:, rows[at + 1]]
        P[:, windows] = gains.filtered[:, rows[at]] + C @ wider @ transpose(C)
    return Smoothed(x, np.broadcast_to(share_out(P, run.pattern), (series, steps, n, n)))


def compute_smoother_gains(model: LinearModel, gains: Gains) -> Array:
    """Compute the gains C of the Rauch-Tung-Striebel smoother, for each row of a filter's gains.

    The result has the shape (patterns, rows, n, n). The gain of a row needs the next row. If the
    filter's gains do not repeat (`gains.cycle` is 0), the last row has no next row, and the result
    has one row less.
    """
    rows = gains.K.shape[1]
    count = rows if gains.cycle else rows - 1
    following = gains.predicted[:, gains.rows_of(count + 1)[1:]]
    F = model.F if model.F.ndim == 2 else model.F[:count]
    return compute_smoother_gain(gains.filtered[:, :count], F, following)


def compute_smoother_gain(filtered: Array, F: Array, following: Array) -> Array:
    """Compute the gain C = P[k|k] F' P[k+1|k]^-1 of the Rauch-Tung-Striebel smoother.

    `filtered` is P[k|k], `following` is P[k+1|k], and F is the transition matrix; all, and the
    result, have the shape (..., n, n). The inverse is a pseudo-inverse, since P[k+1|k] is singular
    if a state is known exactly. The pseudo-inverse is computed from the correlation matrix, so that
    the choice of units does not affect which states count as known exactly.
    """
    scale = np.sqrt(np.diagonal(following, axis1=-2, axis2=-1))
    scale = np.where(scale > 0.0, scale, 1.0)
    correlation = following / (scale[..., :, None] * scale[..., None, :])
    inverse = np.linalg.pinv(correlation, rcond=KNOWN_EXACTLY, hermitian=True)
    return np.asarray(
        (filtered @ transpose(F) / scale[..., None, :]) @ inverse / scale[..., None, :]
    )
