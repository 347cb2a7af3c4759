"""The fixed-lag smoother, both forms, against least squares over the data that it may see."""

from __future__ import annotations

import numpy as np
import problem
import pytest

from owtsweep.estimation.gains import FixedLagSmoother, smoother_gains
from owtsweep.estimation.windowing import FilterRows, covariances


@pytest.mark.parametrize("window", [0, 1, 5, 9])
def test_window_pass_is_the_least_squares_solution(window: int) -> None:
    gains = problem.gains()
    run = problem.run()
    smoother = FixedLagSmoother(problem.model().A, window)
    for k in range(problem.STEPS):
        row = gains.row(k)
        output = smoother.update(
            run.filtered[k], gains.filtered[row], run.predicted[k], gains.predicted[row]
        )
        if k < window:
            assert output is None
        elif k in (window, 10, problem.STEPS - 1):
            assert output is not None
            dense = problem.smoothed(k)
            at = k - window + 1
            np.testing.assert_allclose(output[0], dense.mean[at], rtol=1e-7, atol=1e-8)
            np.testing.assert_allclose(
                output[1], dense.covariance[at, :, at], rtol=1e-7, atol=1e-10
            )


@pytest.mark.parametrize("window", [1, 5, 9])
def test_both_recursions_are_the_window_pass(window: int) -> None:
    gains = problem.gains()
    run = problem.run()
    A = problem.model().A
    C, D = smoother_gains(gains, A, window)
    e = run.filtered - run.predicted
    smoother = FixedLagSmoother(A, window)
    expected = {}
    for k in range(problem.STEPS):
        row = gains.row(k)
        output = smoother.update(
            run.filtered[k], gains.filtered[row], run.predicted[k], gains.predicted[row]
        )
        if output is not None:
            expected[k - window] = output[0]

    def streamed(k: int) -> problem.Array:
        """Sum over j of C_k ... C_{k+j-1} e_{k+j}."""
        total, product = np.zeros(4), np.eye(4)
        for j in range(1, window + 1):
            product = product @ C[gains.row(k + j - 1)]
            total = total + product @ e[k + j]
        leaving = product @ gains.K[gains.row(k + window)]
        np.testing.assert_allclose(-D[gains.row(k)], leaving, rtol=1e-9, atol=1e-12)
        return total

    last = problem.STEPS - 1 - window
    S = streamed(last)
    for k in range(last, -1, -1):
        if k < last:  # DESIGN.md: backwards in O(1)
            taken_back = D[gains.row(k + 1)] @ run.innovations[k + 1 + window]
            S = C[k] @ (e[k + 1] + S + taken_back)
        np.testing.assert_allclose(S, streamed(k), rtol=1e-8, atol=1e-11)
        np.testing.assert_allclose(run.filtered[k] + S, expected[k], rtol=1e-8, atol=1e-11)


@pytest.mark.parametrize("window", [3, 2 * problem.INTERVAL + 1])
def test_what_leaves_the_window_when_the_rows_repeat(window: int) -> None:
    gains = problem.gains()
    C, D = smoother_gains(gains, problem.model().A, window)
    for k in range(gains.rows - gains.cycle - window, gains.rows):
        taken_back = -gains.K[gains.row(k + window)]
        for step in range(k + window - 1, k - 1, -1):
            taken_back = C[gains.row(step)] @ taken_back
        np.testing.assert_allclose(D[k], taken_back, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize(("window", "inputs"), [(0, 3), (4, 4), (4, 9), (9, 6)])
def test_window_covariances_are_the_dense_ones(window: int, inputs: int) -> None:
    gains = problem.gains()
    C, _ = smoother_gains(gains, problem.model().A, max(window, 1))
    response = np.random.default_rng(3).normal(size=(inputs, 3))
    smoothed = np.zeros_like(gains.filtered)
    coupling = np.zeros((gains.rows, 4, 3))
    rows = FilterRows(gains.filtered, gains.predicted, C)
    covariances(rows, window, problem.FAST, response, smoothed, coupling)
    for k in (window, 10, problem.STEPS - 1):
        joint = problem.smoothed(k).covariance
        s = k - window + 1
        np.testing.assert_allclose(smoothed[k], joint[s, :, s], rtol=1e-7, atol=1e-10)
        expected = sum(
            np.outer(joint[s, :, s + i] @ problem.FAST, response[i])
            for i in range(min(window + 1, inputs))
        )
        np.testing.assert_allclose(coupling[k], expected, rtol=1e-6, atol=1e-9)
