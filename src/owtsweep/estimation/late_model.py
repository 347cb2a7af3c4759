"""A motion with a known spectrum, seen by a fast sensor and by a slow sensor that reports the past.

The model is one axis of a motion that a shaping filter makes of white noise. A fast sensor with a
bias measures it at every step, a slow sensor every `interval` steps. The slow measurement reports
the output of `delay` steps before its arrival. So the state keeps a copy of each output whose
report is still to come. A copy is correlated with the state as the output itself was, and the late
measurement is applied to the copy exactly: stochastic cloning (Roumeliotis and Burdick 2002).

The state has N numbers: the n states of the shaping filter, the bias of the fast sensor, and the
copies, the newest first. In each step the state is predicted, the fast measurement is applied, then
the slow one if there is one, and then the output is copied if it will be reported.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array


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
