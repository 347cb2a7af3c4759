"""A motion with a known spectrum, seen by a fast sensor and by a slow one that reports the past.

The model is one axis of a motion that a shaping filter makes of white noise. A fast sensor with a
bias measures it at every step, a slow sensor every `interval` steps. The slow measurement reports
the output of `delay` steps before its arrival. So the state keeps a copy of each output whose
report is still to come. A copy is correlated with the state as the output itself was, and the late
measurement is applied to the copy exactly: stochastic cloning (Roumeliotis and Burdick 2002).

The state has N numbers: the n states of the shaping filter, the bias of the fast sensor, and the
copies, the newest first. In each step the state is predicted, the fast measurement is applied, then
the slow one if there is one, and then the output is copied if it will be reported.

The gains depend on the model and on the variances of noise, not on measured values. After a
transient they are periodic: the period, a cycle, is the time from one slow measurement to the next.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError

#: Largest scaled change of the covariance over a cycle that still counts as converged.
TOLERANCE = 1e-12
#: Number of steps of the first attempt to reach the cycle; each further attempt has twice as many.
FIRST_STEPS = 8192


class LateModel(NamedTuple):
    """A model in discrete time with a fast measurement and a slow measurement that comes late.

    Attributes
    ----------
    A
        Transition matrix of the shaping filter as blocks along its diagonal, shape (n / 2, 2, 2).
    Q
        Covariance of the shaping filter's process noise, shape (n, n).
    walk
        Variance that the bias of the fast sensor gains in a step.
    fast, slow
        Rows (n,): the fast measurement without bias and noise, and the output that the slow
        measurement reports.
    r_fast, r_slow
        Variances of the noise of the two measurements.
    interval, delay
        Steps from one slow measurement to the next, and age of the output that it reports, in
        steps. Slow measurements come at steps 0, interval, 2 interval, ...
    copies
        Number of copies in the state: delay / interval, rounded up.
    """

    A: Array
    Q: Array
    walk: float
    fast: Array
    slow: Array
    r_fast: float
    r_slow: float
    interval: int
    delay: int
    copies: int


def find_first_covariance(model: LateModel, stationary: Array, bias_variance: float) -> Array:
    """Compute the covariance (N, N) of the state one step before step 0.

    Nothing is measured before step 0. But the first slow measurements report outputs of before step
    0, so the state already has their copies. `stationary` (n, n) is the covariance of the shaping
    filter's states; `bias_variance` is the variance of the bias one step before step 0.
    """
    n = len(model.Q)
    N = n + 1 + model.copies
    P = np.zeros((N, N))
    P[:n, :n] = stationary
    P[n, n] = bias_variance
    predict, copy = transition(model), copying(model)
    Q = np.zeros((N, N))
    Q[:n, :n] = model.Q
    for step in range(-model.delay, 0):
        if step > -model.delay:
            P = predict @ P @ predict.T + Q
        if (step + model.delay) % model.interval == 0:
            P = copy @ P @ copy.T
    return 0.5 * (P + P.T)


def transition(model: LateModel) -> Array:
    """Return the transition matrix (N, N) of a state over a step, without a new copy."""
    n = len(model.Q)
    F = np.eye(n + 1 + model.copies)
    for i, block in enumerate(model.A):
        F[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = block
    return F


def copying(model: LateModel) -> Array:
    """Return the matrix (N, N) that makes the present output the newest copy of a state.

    The matrix moves the other copies on by one place and drops the oldest. It is the identity if
    the model has no copies.
    """
    n = len(model.Q)
    N = n + 1 + model.copies
    C = np.eye(N)
    if model.copies:
        C[n + 1 :] = 0.0
        C[n + 1, :n] = model.slow
        C[range(n + 2, N), range(n + 1, N - 1)] = 1.0
    return C


class LateRows(NamedTuple):
    """The arrays that the covariance recursion fills.

    Attributes
    ----------
    fast
        Gains of the fast measurement, shape (rows, N), one row per step.
    slow
        Gains of the slow measurement, shape (rows / interval, N), one row per slow measurement.
    S
        Variance of the slow measurement's innovation, shape (rows / interval,).
    outputs
        Covariance (c, c) of c outputs of the state after the measurements of a step, shape
        (rows, c, c).
    """

    fast: Array
    slow: Array
    S: Array
    outputs: Array


@dataclass(frozen=True, eq=False)
class LateGains:
    """The gains and covariances of a filter, for steps 0, 1, ... of every record.

    The state has N numbers: the n states of the shaping filter, the bias, and the copies (see
    `estimation.late_model`). After the last row, the last `cycle` rows repeat for ever.

    Attributes
    ----------
    fast
        Gains of the fast measurement, shape (rows, N), one row per step.
    slow
        Gains of the slow measurement, shape (rows / cycle, N), one row per slow measurement.
    innovation_variance
        Variance of the slow measurement's innovation, shape (rows / cycle,).
    covariance
        Covariance of the c chosen outputs after the measurements of a step, shape (rows, c, c).
    cycle
        Number of rows that repeat: steps from one slow measurement to the next.
    repeats
        Whether the covariances have settled; otherwise they still moved at the last row.
    """

    fast: Array
    slow: Array
    innovation_variance: Array
    covariance: Array
    cycle: int
    repeats: bool

    @property
    def rows(self) -> int:
        """The number of stored rows."""
        return len(self.fast)


def schedule_late(model: LateModel, first: Array, outputs: Array, steps: int) -> LateGains:
    """Compute the gains of a filter until they repeat.

    Parameters
    ----------
    model
        The model, with a state of N numbers, n of them states of the shaping filter.
    first
        Covariance (N, N) of the state one step before step 0.
    outputs
        Rows (c, n) of the outputs whose covariances are wanted.
    steps
        Number of steps of the longest record: gains are computed for at most so many steps, rounded
        up to a whole number of cycles.

    Raises
    ------
    InputError
        If a variance of an output becomes negative or not finite, because the numbers of the model
        differ too much in magnitude.
    """
    from owtsweep.estimation.late import late_recursion

    N, M, c = len(first), model.interval, len(outputs)
    last = -(-steps // M) * M
    rows = LateRows(*(np.empty((0, *shape)) for shape in ((N,), (N,), (), (c, c))))
    P, before = first.copy(), np.full((N, N), np.nan)
    filled, repeats, size = 0, False, FIRST_STEPS
    while not repeats and filled < last:
        size = min(-(-size // M) * M, last)
        rows = LateRows(
            _lengthen(rows.fast, size),
            _lengthen(rows.slow, size // M),
            _lengthen(rows.S, size // M),
            _lengthen(rows.outputs, size),
        )
        filled, repeats = late_recursion(
            filled, size, model, P, np.ascontiguousarray(outputs), TOLERANCE, before, rows
        )
        size *= 2
    covariance = rows.outputs[:filled]
    variances = np.diagonal(covariance, axis1=1, axis2=2)
    if not np.all(np.isfinite(variances) & (variances > 0.0)):
        raise InputError(
            "skf: the filter's covariance is negative or infinite, because the variances of "
            "motion, sensors and bias differ too much in magnitude; use less extreme values"
        )
    return LateGains(
        fast=rows.fast[:filled].copy(),
        slow=rows.slow[: filled // M].copy(),
        innovation_variance=rows.S[: filled // M].copy(),
        covariance=covariance.copy(),
        cycle=M,
        repeats=repeats,
    )


def _lengthen(array: Array, rows: int) -> Array:
    """Return an array of `rows` rows that begins with the rows of `array`."""
    result = np.empty((rows, *array.shape[1:]))
    result[: len(array)] = array
    return result
