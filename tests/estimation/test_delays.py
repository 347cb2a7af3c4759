"""Late measurements against brute force: the state given all that has arrived by then."""

from __future__ import annotations

import numpy as np
import pytest
from joint import Joint, draw_case, simulate
from scipy.stats import chi2

from owtsweep.errors import InputError
from owtsweep.estimation.delays import filter_delayed
from owtsweep.estimation.kalman import run_filter
from owtsweep.estimation.smoothing import smooth_fixed_lag


@pytest.mark.parametrize("lag", [0, 3])
@pytest.mark.parametrize(
    ("settings", "longest"),
    [
        ({"seed": 1, "n": 1, "m": 1}, 2),
        ({"seed": 2, "n": 3, "m": 2, "lost": 0.3, "inputs": 1}, 5),
        ({"seed": 3, "n": 6, "m": 4, "lost": 0.2, "changing": True}, 4),
        ({"seed": 4, "n": 4, "m": 3, "rank": 2}, 20),
    ],
)
def test_each_estimate_is_given_what_has_arrived(settings: dict, longest: int, lag: int) -> None:
    case = draw_case(**settings)
    delay = np.random.default_rng(settings["seed"]).integers(0, longest + 1, case.z.shape)
    result = filter_delayed(
        case.model, case.z, delay, state=case.mean, covariance=case.covariance,
        inputs=case.inputs, lag=lag,
    )  # fmt: skip
    joint, steps = Joint(case), case.z.shape[1]
    arrival = np.arange(steps)[:, None] + delay
    for s, z in enumerate(case.z):
        quadratic = 0.0
        for k in range(steps):
            used = np.isfinite(z) & (arrival[s] <= min(k + lag, steps - 1))
            mean, covariance = joint.condition(z, used, k)
            np.testing.assert_allclose(result.state[s, k], mean, rtol=1e-7, atol=1e-7)
            np.testing.assert_allclose(result.covariance[s, k], covariance, rtol=1e-7, atol=1e-7)
            used = np.isfinite(z) & (arrival[s] <= k)
            before, quadratic = quadratic, joint.quadratic(z, used)
            assert result.nis[s, k] == pytest.approx(quadratic - before, rel=1e-6, abs=1e-7)
            assert result.arrived[s, k] == np.sum(np.isfinite(z) & (arrival[s] == k))


def test_without_delay_it_is_the_filter_and_the_smoother() -> None:
    case = draw_case(5, 4, 2, lost=0.3, steps=25)
    run = run_filter(case.model, case.z, state=case.mean, covariance=case.covariance)
    for lag in (0, 4):
        late = filter_delayed(
            case.model, case.z, 0, state=case.mean, covariance=case.covariance, lag=lag
        )
        smoothed = smooth_fixed_lag(run, lag)
        np.testing.assert_allclose(late.state, smoothed.state, rtol=1e-10, atol=1e-12)
        np.testing.assert_allclose(late.covariance, smoothed.covariance, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(late.nis, run.nis, rtol=1e-9, atol=1e-12)


def test_one_delay_of_one_sensor() -> None:
    """A fast sensor on time and a slow one that is late by a constant, as GNSS beside an IMU."""
    case = draw_case(6, 3, 2, steps=30)
    case.z[:, np.arange(30) % 5 != 0, 1] = np.nan
    late = filter_delayed(
        case.model, case.z, np.array([0, 3]), state=case.mean, covariance=case.covariance
    )
    arrived = case.z.copy()
    arrived[:, 28:, 1] = np.nan  # would arrive after the end
    run = run_filter(case.model, arrived, state=case.mean, covariance=case.covariance)
    np.testing.assert_allclose(late.state[:, -1], run.filtered[:, -1], rtol=1e-10)
    assert late.arrived[0, [0, 3, 4, 8]].tolist() == [1, 2, 1, 2]


def test_nis_of_late_measurements_is_consistent() -> None:
    case = draw_case(7, 3, 2)
    random, series = np.random.default_rng(1), 400
    _, z = simulate(case.model, case.mean, case.covariance, None, series, 20, random)
    delay = random.integers(0, 5, (20, 2))
    late = filter_delayed(case.model, z, delay, state=case.mean, covariance=case.covariance)
    low, high = chi2.ppf([5e-7, 1 - 5e-7], late.arrived.sum())
    assert low < late.nis.sum() < high


@pytest.mark.parametrize(
    ("delay", "message"),
    [
        (-1, "delay: give whole numbers of steps, 0 or more"),
        (0.5, "delay: give whole numbers of steps, 0 or more"),
        (np.zeros(3, dtype=int), r"delay: the shape \(3,\) does not fit"),
    ],
)
def test_delays_that_cannot_be(delay: object, message: str) -> None:
    case = draw_case(8, 2, 2)
    with pytest.raises(InputError, match=message):
        filter_delayed(case.model, case.z, delay, state=case.mean, covariance=case.covariance)  # type: ignore[arg-type]
