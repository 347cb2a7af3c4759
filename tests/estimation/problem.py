"""A small two-rate problem: one axis of position, velocity, acceleration and bias."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
from dense import Array, Measurement, Posterior, posterior

from owtsweep.estimation.discretisation import Discrete, Model, discretise
from owtsweep.estimation.gains import RULES, GainSchedule, schedule
from owtsweep.estimation.riccati import TwoRates

SLOW = np.array([1.0, 0.0, 0.0, 0.0])
FAST = np.array([0.0, 0.0, 1.0, -1.0])
SLOW_VARIANCE, FAST_VARIANCE = 0.03**2, 0.15**2
INTERVAL = 7
STEPS = 40
STEP = 0.1
PRIOR = np.diag([1.0, 0.5, 2.0, 0.1])


def model() -> Discrete:
    """Acceleration and bias driven by white noise."""
    A = np.zeros((4, 4))
    A[0, 1] = A[1, 2] = 1.0
    continuous = Model(A=A, B=np.zeros((4, 1)), Q=np.diag([0.0, 0.0, 0.8, 0.01]))
    discrete = discretise(continuous, STEP)
    # in the order of the studies' models, for which kernels are compiled
    return replace(discrete, A=np.ascontiguousarray(discrete.A))


@cache
def gains() -> GainSchedule:
    """Its schedule."""
    return schedule(rates("proper"), PRIOR, interval=INTERVAL, steps=10_000)


def rates(
    rule: str, slow_variance: float = SLOW_VARIANCE, fast_variance: float = FAST_VARIANCE
) -> TwoRates:
    """The model with its measurements; `rule` is one of `RULES`."""
    A, Q = model().A, model().Q
    return TwoRates(A, Q, SLOW, FAST, slow_variance, fast_variance, RULES.index(rule))


class Filtered(NamedTuple):
    """A run with the schedule's gains.

    predicted and filtered (steps, 4) states; innovations (steps, 2) of the slow measurement, zero
    where there is none, and of the fast one.
    """

    predicted: Array
    filtered: Array
    innovations: Array


#: Any numbers will do: fast and slow (STEPS,), of which every seventh is used.
FAST_DATA, SLOW_DATA = np.random.default_rng(11).normal(size=(2, STEPS))


@cache
def run() -> Filtered:
    """The filter on the data as a plain loop over the schedule's gains."""
    A = model().A
    x = np.zeros(4)
    result = Filtered(np.empty((STEPS, 4)), np.empty((STEPS, 4)), np.zeros((STEPS, 2)))
    for k in range(STEPS):
        x = A @ x
        result.predicted[k] = x
        result.innovations[k, 1] = FAST_DATA[k] - FAST @ x
        if k % INTERVAL == 0:
            result.innovations[k, 0] = SLOW_DATA[k] - SLOW @ x
        x = x + gains().K[gains().row(k)] @ result.innovations[k]
        result.filtered[k] = x
    return result


@cache
def smoothed(last: int) -> Posterior:
    """Dense solution given the data of steps 0 ... last."""
    measurements = [Measurement(k, FAST, FAST_DATA[k], FAST_VARIANCE) for k in range(last + 1)]
    measurements += [
        Measurement(k, SLOW, SLOW_DATA[k], SLOW_VARIANCE) for k in range(0, last + 1, INTERVAL)
    ]
    return posterior(model(), PRIOR, np.zeros((last + 1, 1)), measurements)
