"""The gain schedule against least squares over the whole record."""

from __future__ import annotations

import numpy as np
import problem
import pytest

from owtsweep.errors import InputError
from owtsweep.estimation.gains import schedule


@pytest.mark.parametrize("last", [0, 6, 7, 39])
def test_the_filter_is_the_least_squares_solution(last: int) -> None:
    gains = problem.gains()
    dense = problem.smoothed(last)
    np.testing.assert_allclose(problem.run().filtered[last], dense.mean[-1], rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(
        gains.filtered[last], dense.covariance[-1, :, -1], rtol=1e-8, atol=1e-11
    )


def test_the_innovation_variance_is_that_of_the_predicted_measurement() -> None:
    gains = problem.gains()
    dense = problem.smoothed(6)
    A, Q = problem.model().A, problem.model().Q
    predicted = A @ dense.covariance[-1, :, -1] @ A.T + Q
    np.testing.assert_allclose(gains.predicted[7], predicted, rtol=1e-8, atol=1e-11)
    assert gains.innovation_variance[7] == pytest.approx(
        predicted[0, 0] + problem.SLOW_VARIANCE, rel=1e-9
    )


def test_the_stored_cycle_repeats() -> None:
    gains = problem.gains()
    assert gains.cycle == problem.INTERVAL
    assert gains.rows % gains.cycle == 0
    longer = problem.model()
    P = gains.filtered[-1]
    for k in range(gains.rows, gains.rows + 3 * gains.cycle):
        P = longer.A @ P @ longer.A.T + longer.Q
        H = np.array([problem.SLOW, problem.FAST] if k % problem.INTERVAL == 0 else [problem.FAST])
        R = np.diag([problem.SLOW_VARIANCE, problem.FAST_VARIANCE][-len(H) :])
        P = P - P @ H.T @ np.linalg.solve(H @ P @ H.T + R, H @ P)
        np.testing.assert_allclose(gains.filtered[gains.row(k)], P, rtol=1e-9)
    assert gains.row(gains.rows - 1) == gains.rows - 1
    assert gains.row(gains.rows) == gains.rows - gains.cycle


def test_fresh_marks_the_steps_with_a_slow_measurement() -> None:
    gains = schedule(
        problem.rates("mask_rows", 1.0, 1.0), problem.PRIOR, interval=2, steps=500,
        start_interval=6, start_steps=12,
    )  # fmt: skip
    assert np.flatnonzero(gains.fresh[:18]).tolist() == [0, 6, 12, 14, 16]
    whole = gains.fresh[gains.row(np.arange(700))]
    assert [gains.fresh_before(k) for k in range(700)] == [*np.cumsum([0, *whole[:-1]])]
    assert gains.applied.all()  # the literal row mask goes on using the last one


def test_a_covariance_that_turns_negative_is_refused() -> None:
    with pytest.raises(InputError, match=r"update_rule: 'mask_rows' .* use 'proper'"):
        schedule(problem.rates("mask_rows", 1e-6, 1e-2), problem.PRIOR, interval=10, steps=500)
