"""The filter of `late` on one series, whose slow measurements count by how far off they are.

Here the gains depend on the measurements, so they cannot be computed before: each step corrects
the covariance too. A slow measurement is judged by its innovation before it is used. Its weight w
raises the innovation's variance to its 1 / w-fold; with weight 0 it is left out, as one that has
not arrived.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.compiled import njit
from owtsweep.estimation.late import (
    apply_fast,
    copy_covariance,
    correct_covariance,
    find_slow_column,
    is_copied,
    predict_covariance,
    write_outputs,
)


class Weighing(NamedTuple):
    """How a slow measurement's weight follows from its distance, in standard deviations.

    limit: the distance up to which the weight is 1.
    fades: whether the weight beyond is limit / distance (Huber 1964); else it is 0 (a gate).
    patience: number of measurements in a row that a gate leaves out; then it takes all, until one
        lies within the limit.
    """

    limit: float
    fades: bool
    patience: int


#: All measurements count alike.
ALIKE = Weighing(math.inf, False, 0)


class WeighedState(NamedTuple):
    """The state of a filter that weighs.

    x, P: state (N,) and its covariance (N, N), before the next step.
    beyond: number of measurements in a row beyond the limit, up to now, shape (1,).
    """

    x: Array
    P: Array
    beyond: Array


class WeighedEstimates(NamedTuple):
    """What the filter makes of some steps.

    outputs, covariance: the two outputs, shape (steps, 2), and their covariance, (steps, 2, 2).
    innovation, variance, weight: of slow measurements, shape (steps,); NaN at steps without one.
        The variance is that before the measurement is weighed.
    """

    outputs: Array
    covariance: Array
    innovation: Array
    variance: Array
    weight: Array


@njit
def follow_weighing(first, force, slow, model, outputs, weighing, state, filled):
    """Run the filter on one series.

    first: number of the first step.
    force, slow: fast and slow measurements, shape (steps,) each; slow ones are NaN at steps
        without one.
    model, outputs: the `LateModel`, and the rows (2, n) of its two outputs.
    weighing, state: `Weighing` and `WeighedState`; the latter is overwritten.
    filled: the `WeighedEstimates` to fill.
    """
    x, P = state.x, state.P
    n, N = len(model.Q), len(state.x)
    gain, work = np.empty(N), np.empty(n)
    for k in range(len(force)):
        predict_state(model, x)
        predict_covariance(model, P)
        apply_fast(model, P, gain)
        residual = force[k] - x[n]
        for i in range(n):
            residual -= model.fast[i] * x[i]
        for i in range(N):
            x[i] += gain[i] * residual
        if slow[k] == slow[k]:  # it has arrived
            weigh_slow(slow[k], model, weighing, state, gain, filled, k)
        else:
            filled.innovation[k] = filled.variance[k] = filled.weight[k] = np.nan
        for a in range(2):
            total = 0.0
            for i in range(n):
                total += outputs[a, i] * x[i]
            filled.outputs[k, a] = total
        write_outputs(P, outputs, work, filled.covariance[k])
        if is_copied(model, first + k):
            copy_state(model, x)
            copy_covariance(model, P)


@njit
def weigh_slow(measured, model, weighing, state, gain, filled, k):
    """Judge a slow measurement, and correct state and covariance by it as it deserves."""
    x, P, n, N = state.x, state.P, len(model.Q), len(state.x)
    residual = measured
    if model.copies > 0:
        residual -= x[N - 1]
    else:
        for i in range(n):
            residual -= model.slow[i] * x[i]
    if model.reds > 0:
        residual -= x[n + 1]
    variance = find_slow_column(model, P, gain)
    weight = weigh(abs(residual) / np.sqrt(variance), weighing, state.beyond)
    filled.innovation[k], filled.variance[k], filled.weight[k] = residual, variance, weight
    if weight > 0.0:
        correct_covariance(P, gain, variance / weight)
        for i in range(N):
            x[i] += gain[i] * residual


@njit
def weigh(distance, weighing, beyond):
    """Return the weight, from 0 to 1, of the next measurement, and count those beyond the limit."""
    if distance <= weighing.limit:
        beyond[0] = 0
        return 1.0
    beyond[0] += 1
    if weighing.fades:
        return weighing.limit / distance
    return 0.0 if beyond[0] <= weighing.patience else 1.0


@njit
def predict_state(model, x):
    """Move the state x (N,) on by a step."""
    A, n = model.A, len(model.Q)
    for i in range(n // 2):
        one, two = x[2 * i], x[2 * i + 1]
        x[2 * i] = A[i, 0, 0] * one + A[i, 0, 1] * two
        x[2 * i + 1] = A[i, 1, 0] * one + A[i, 1, 1] * two
    if model.reds > 0:
        x[n + 1] *= model.fade


@njit
def copy_state(model, x):
    """Make the present output the newest copy in the state x (N,); drop the oldest copy."""
    n = len(model.Q)
    new = n + 1 + model.reds
    for i in range(len(x) - 1, new, -1):
        x[i] = x[i - 1]
    total = 0.0
    for i in range(n):
        total += model.slow[i] * x[i]
    x[new] = total
