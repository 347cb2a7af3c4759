"""Gains that repeat, against the filter that computes each step's own."""

from __future__ import annotations

import numpy as np
import pytest
from joint import Case, draw_case, simulate

from owtsweep.errors import InputError
from owtsweep.estimation.kalman import apply_gains, run_filter, schedule_gains
from owtsweep.estimation.linear import LinearModel
from owtsweep.estimation.smoothing import smooth, smooth_fixed_lag

STEPS = 400


def slow_and_fast(case: Case, cycle: int) -> np.ndarray:
    """The first sensor once in a cycle, the others always; (cycle, m)."""
    available = np.ones((cycle, case.model.measurements), dtype=bool)
    available[1:, 0] = False
    return available


@pytest.mark.parametrize(("n", "m", "cycle"), [(1, 1, 1), (2, 1, 7), (4, 2, 10), (6, 3, 4)])
def test_a_schedule_is_the_time_varying_filter(n: int, m: int, cycle: int) -> None:
    case = draw_case(n, n, m)
    available = slow_and_fast(case, cycle)
    _, z = simulate(
        case.model, case.mean, case.covariance, None, 5, STEPS, np.random.default_rng(2)
    )
    z[:, ~available[np.arange(STEPS) % cycle]] = np.nan
    prior = {"state": case.mean, "covariance": case.covariance}
    gains = schedule_gains(case.model, case.covariance, available, STEPS)
    assert gains.cycle == cycle
    assert gains.K.shape[1] < STEPS
    run = run_filter(case.model, z, **prior)
    scheduled = apply_gains(case.model, gains, z, state=case.mean)
    largest = np.max(np.abs(run.filtered))
    assert np.max(np.abs(scheduled.filtered - run.filtered)) < 1e-12 * largest
    largest = np.max(np.abs(run.covariance))
    assert np.max(np.abs(scheduled.covariance - run.covariance)) < 1e-12 * largest
    for smoother in (smooth, lambda run: smooth_fixed_lag(run, 9)):
        ours, theirs = smoother(scheduled), smoother(run)
        np.testing.assert_allclose(ours.state, theirs.state, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(ours.covariance, theirs.covariance, rtol=1e-9, atol=1e-9)


def test_slow_convergence_is_waited_for() -> None:
    """A bias that hardly moves takes thousands of steps to settle."""
    model = LinearModel(np.eye(1), np.full((1, 1), 1e-6), np.eye(1), np.eye(1))
    gains = schedule_gains(model, np.eye(1), np.ones((1, 1), dtype=bool), 1_000_000)
    steady = 0.5 * (1e-6 + np.sqrt(1e-12 + 4e-6))  # P of P^2 - Q P - Q R = 0
    assert gains.cycle == 1
    assert gains.predicted[0, -1, 0, 0] == pytest.approx(steady, rel=1e-11)


def test_what_is_never_observed_never_settles() -> None:
    model = LinearModel(np.eye(2), np.eye(2), np.array([[1.0, 0.0]]), np.eye(1))
    gains = schedule_gains(model, np.eye(2), np.ones((1, 1), dtype=bool), 50)
    assert gains.cycle == 0
    assert gains.K.shape[1] == 50
    with pytest.raises(InputError, match="51 steps are more than the 50 of the gains"):
        apply_gains(model, gains, np.zeros((1, 51, 1)), state=np.zeros(2))


def test_other_losses_than_the_schedule_s_are_refused() -> None:
    case = draw_case(3, 2, 1)
    gains = schedule_gains(case.model, case.covariance, np.ones((2, 1), dtype=bool), 400)
    z = np.zeros((1, 300, 1))
    z[0, 250] = np.nan
    with pytest.raises(InputError, match="other components are lost"):
        apply_gains(case.model, gains, z, state=case.mean)


@pytest.mark.parametrize("shape", [(0, 1), (3, 2), (3,)])
def test_patterns_that_do_not_fit(shape: tuple[int, ...]) -> None:
    case = draw_case(3, 2, 1)
    with pytest.raises(InputError, match="available: has the shape"):
        schedule_gains(case.model, case.covariance, np.ones(shape, dtype=bool), 10)


def test_a_changing_model_is_refused() -> None:
    case = draw_case(3, 2, 1, changing=True)
    with pytest.raises(InputError, match="model: changes with time"):
        schedule_gains(case.model, case.covariance, np.ones((2, 1), dtype=bool), 10)
