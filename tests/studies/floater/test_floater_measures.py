"""The floater study's measures by brute force."""

from __future__ import annotations

import numpy as np
import pytest

from owtsweep.studies.floater.contract import DOF, Estimates, Truth
from owtsweep.studies.floater.measures import CRITERIA, MEASURES, NotFinite, compare

STEP, STEPS, SETTLED = 0.05, 3000, 500
SIGMA = np.array([0.3, 0.1, 0.2, 0.01, 0.02, 0.03])


def move(times):
    """Return position and velocity of two lines per degree of freedom, shape (n, 6) each."""
    omega = 2.0 * np.pi / np.array([[38.0], [10.0]])
    size, phase = np.array([[3.0], [0.4]]), np.arange(6) + np.array([[0.0], [1.0]])
    angle = omega * times[:, None, None] + phase
    return np.sum(size * np.sin(angle), axis=1), np.sum(size * omega * np.cos(angle), axis=1)


@pytest.fixture
def truth() -> Truth:
    position, velocity = move(STEP * np.arange(STEPS))
    none = np.zeros((STEPS, 3))
    return Truth(STEP, position + 8.5 * (np.arange(6) < 3), velocity, 0.0 * position, none, none)


@pytest.fixture
def estimates(truth: Truth) -> Estimates:
    rng = np.random.default_rng(4)
    root = rng.standard_normal((STEPS, 6, 2, 2))
    errors = 0.05 * rng.standard_normal((2, STEPS, 6))
    errors[:, :SETTLED] = 1e3
    nis = rng.standard_normal((STEPS, 6)) ** 2
    nis[rng.random((STEPS, 6)) < 0.3] = np.nan
    covariance = root @ root.swapaxes(-1, -2) + 0.1 * np.eye(2)
    return Estimates(truth.position + errors[0], truth.velocity + errors[1], covariance, nis)


def test_measures_are_what_their_names_say(truth: Truth, estimates: Estimates) -> None:
    found = compare(truth, estimates, SIGMA, SETTLED)
    after = slice(SETTLED, None)
    error = (estimates.position - truth.position)[after]
    velocity = (estimates.velocity - truth.velocity)[after]
    both = np.stack([error, velocity], axis=-1)
    P = estimates.covariance[after]
    nees = np.einsum("kdi,kdij,kdj->kd", both, np.linalg.inv(P), both).mean(axis=0) / 2.0
    rms, true = np.sqrt(np.mean(error**2, axis=0)), truth.position[after]
    floor = np.maximum(np.abs(true), 0.1 * np.sqrt(np.mean(true**2, axis=0)))
    expected = {
        "mse_position": rms**2,
        "mse_velocity": np.mean(velocity**2, axis=0),
        "noise_ratio": rms / SIGMA,
        "rms_over_p": rms / np.sqrt(P[:, :, 0, 0].mean(axis=0)),
        "nees": nees,
        "nis": np.nanmean(estimates.nis[after], axis=0),
        "relative": 100.0 * np.percentile(np.abs(error) / floor, 95.0, axis=0),
    }
    for name, values in expected.items():
        got = [found[f"{name}_{dof}"] for dof in DOF]
        np.testing.assert_allclose(got, values, rtol=1e-9, err_msg=name)
    share = rms / true.std(axis=0)
    of_velocity = np.mean(velocity**2, axis=0) / truth.velocity[after].var(axis=0)
    assert found["position"] == pytest.approx(np.sqrt(np.mean(share**2)))
    assert found["velocity"] == pytest.approx(np.sqrt(np.mean(of_velocity)))
    assert found["worst"] == pytest.approx((rms / SIGMA).max())
    assert found["nees"] == pytest.approx(nees.mean())
    assert found["relative"] == pytest.approx(expected["relative"].max())
    assert list(MEASURES[:3]) == list(CRITERIA)
    assert set(CRITERIA) <= set(found) <= set(MEASURES)


def test_a_constant_covariance_is_that_of_every_sample(truth: Truth, estimates: Estimates) -> None:
    one = estimates.covariance[:1]
    repeated = Estimates(estimates.position, estimates.velocity, np.repeat(one, STEPS, axis=0))
    steady = Estimates(estimates.position, estimates.velocity, one)
    assert compare(truth, steady, SIGMA, SETTLED) == pytest.approx(
        compare(truth, repeated, SIGMA, SETTLED)
    )


def test_what_a_scheme_does_not_say_is_not_measured(truth: Truth) -> None:
    plain = Estimates(truth.position + 0.1, truth.velocity, latency=1.5)
    found = compare(truth, plain, SIGMA, SETTLED)
    assert not [name for name in found if name.startswith(("nees", "nis", "rms_over_p"))]
    assert found["wait"] == 1.5
    assert "wait" not in compare(truth, Estimates(truth.position, truth.velocity), SIGMA, SETTLED)


@pytest.mark.parametrize("late", [0.0, 0.07, -0.12, 1.0, -2.0])
def test_lag_is_by_what_an_estimate_comes_late(truth: Truth, late: float) -> None:
    position, velocity = move(STEP * np.arange(STEPS) - late)
    found = compare(truth, Estimates(position - 3.0, velocity), SIGMA, SETTLED)
    for dof in DOF:
        assert found[f"lag_position_{dof}"] == pytest.approx(1000.0 * late, rel=0.03, abs=1e-3)
        assert found[f"lag_velocity_{dof}"] == pytest.approx(1000.0 * late, rel=0.03, abs=1e-3)
    assert found["lag_velocity"] == pytest.approx(1000.0 * late, rel=0.03, abs=1e-3)


def test_what_does_not_move_counts_in_no_criterion(truth: Truth, estimates: Estimates) -> None:
    truth.position[:, 2] = 0.0
    truth.velocity[:, 2] = 0.0
    estimates.position[:, 2] = 5.0
    sigma = SIGMA * (np.arange(6) != 2)
    found = compare(truth, estimates, sigma, SETTLED)
    rest = [i for i in range(6) if i != 2]
    share = (estimates.position - truth.position)[SETTLED:, rest].std(axis=0)
    share /= truth.position[SETTLED:, rest].std(axis=0)
    assert found["position"] == pytest.approx(np.sqrt(np.mean(share**2)), rel=1e-2)
    assert found["worst"] == max(found[f"noise_ratio_{DOF[i]}"] for i in rest)
    assert "noise_ratio_z" not in found


def test_an_estimate_that_is_not_finite_is_refused(truth: Truth, estimates: Estimates) -> None:
    estimates.velocity[-1, 3] = np.inf
    with pytest.raises(NotFinite):
        compare(truth, estimates, SIGMA, SETTLED)
