"""The steady covariance by doubling: against the Riccati equation, and against many steps."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from owtsweep import InputError
from owtsweep.estimation.periodic import find_steady_covariance, make_prediction, make_update

A = np.array([[0.9, 0.3, 0.0], [-0.3, 0.8, 0.1], [0.0, 0.0, 1.0]])
Q = np.diag([0.1, 0.02, 1e-4])
ROW = np.array([1.0, 0.0, 0.5])


def test_one_step_is_the_riccati_equation() -> None:
    period = make_update(ROW, 0.3).then(make_prediction(A, Q))
    wanted = solve_discrete_are(A.T, ROW[:, None], Q, np.array([[0.3]]))
    assert find_steady_covariance(period) == pytest.approx(wanted, rel=1e-8)


def test_a_period_of_two_rates_repeats_itself() -> None:
    slow, step = np.array([0.0, 1.0, 0.0]), make_update(ROW, 0.3).then(make_prediction(A, Q))
    period = make_update(slow, 0.05).then(step.repeat(7))
    P = 10.0 * np.eye(3)
    for index in range(7 * 400):
        rows = [(slow, 0.05)] * (index % 7 == 0) + [(ROW, 0.3)]
        for row, variance in rows:
            gain = P @ row / (row @ P @ row + variance)
            P = P - np.outer(gain, row) @ P
        P = A @ P @ A.T + Q
    assert find_steady_covariance(period) == pytest.approx(P, rel=1e-8)
    assert period.apply(P) == pytest.approx(P, rel=1e-8)


def test_a_state_that_nobody_sees_is_refused() -> None:
    blind = make_update(np.array([1.0, 0.0, 0.0]), 0.3)
    walk = make_prediction(np.eye(3), np.eye(3))
    with pytest.raises(InputError, match="has no steady state: the measurements do not see"):
        find_steady_covariance(blind.then(walk))
