"""The Kalman filter against brute force, filterpy and statsmodels."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from joint import Case, Joint, draw_case, simulate
from scipy.stats import chi2

from owtsweep.errors import InputError
from owtsweep.estimation.kalman import Filtered, run_filter
from owtsweep.estimation.linear import LinearModel

SIZES = [(1, 1), (2, 1), (3, 2), (4, 4), (5, 3), (6, 2)]


def filtered(case: Case, **changes: Any) -> Filtered:
    return run_filter(
        case.model, case.z, state=case.mean, covariance=case.covariance,
        **{"inputs": case.inputs, **changes},
    )  # fmt: skip


@pytest.mark.parametrize("changing", [False, True])
@pytest.mark.parametrize(("n", "m"), SIZES)
def test_filter_is_dense_conditioning(n: int, m: int, changing: bool) -> None:
    case = draw_case(n, n, m, changing=changing, inputs=m - 1, lost=0.4)
    run, joint = filtered(case), Joint(case)
    for s, z in enumerate(case.z):
        for k in range(z.shape[0]):
            used = np.isfinite(z)
            used[k + 1 :] = False
            mean, covariance = joint.condition(z, used, k)
            np.testing.assert_allclose(run.filtered[s, k], mean, rtol=1e-8, atol=1e-8)
            np.testing.assert_allclose(run.covariance[s, k], covariance, rtol=1e-8, atol=1e-8)
            earlier = used.copy()
            earlier[k] = False
            nis = joint.quadratic(z, used) - joint.quadratic(z, earlier)
            assert run.nis[s, k] == pytest.approx(nis, rel=1e-7, abs=1e-8)


def test_filter_is_filterpy_s() -> None:
    from filterpy.kalman import KalmanFilter

    case = draw_case(7, 4, 2, inputs=1, lost=0.0, steps=30)
    case.z[0, ::3] = np.nan  # filterpy knows whole losses
    run = filtered(case)
    kf = KalmanFilter(dim_x=4, dim_z=2, dim_u=1)
    kf.x, kf.P = case.mean.copy(), case.covariance.copy()
    kf.F, kf.Q, kf.H, kf.R, kf.B = (*case.model.at(0)[:4], case.model.B)
    assert case.inputs is not None
    for k, z in enumerate(case.z[0]):
        kf.update(None if np.isnan(z[0]) else z)
        np.testing.assert_allclose(run.filtered[0, k], kf.x, rtol=1e-10, atol=1e-12)
        np.testing.assert_allclose(run.covariance[0, k], kf.P, rtol=1e-10, atol=1e-12)
        kf.predict(u=case.inputs[k])


def test_filter_and_smoother_are_those_of_statsmodels() -> None:
    from statsmodels.tsa.statespace.kalman_smoother import KalmanSmoother

    from owtsweep.estimation.smoothing import smooth

    case = draw_case(8, 5, 3, lost=0.3, steps=60)
    run = filtered(case)
    smoothed = smooth(run)
    for s, z in enumerate(case.z):
        other = KalmanSmoother(k_endog=3, k_states=5)
        other.bind(z)
        other["transition"], other["design"] = case.model.F, case.model.H
        other["selection"], other["state_cov"] = np.eye(5), case.model.Q
        other["obs_cov"] = case.model.R
        other.initialize_known(case.mean, case.covariance)
        result = other.smooth()
        for ours, theirs in (
            (run.filtered[s], result.filtered_state.T),
            (run.covariance[s], result.filtered_state_cov.transpose(2, 0, 1)),
            (smoothed.state[s], result.smoothed_state.T),
            (smoothed.covariance[s], result.smoothed_state_cov.transpose(2, 0, 1)),
        ):
            np.testing.assert_allclose(ours, theirs, rtol=1e-8, atol=1e-9)


def test_a_lost_component_is_a_row_that_never_was() -> None:
    case = draw_case(9, 3, 3, steps=20)
    case.z[:, :, 1] = np.nan
    rest = [0, 2]
    model = case.model
    smaller = LinearModel(model.F, model.Q, model.H[rest], model.R[np.ix_(rest, rest)])
    other = run_filter(smaller, case.z[:, :, rest], state=case.mean, covariance=case.covariance)
    np.testing.assert_allclose(filtered(case).filtered, other.filtered, rtol=1e-13, atol=1e-14)
    assert np.all(np.isnan(filtered(case).innovation[:, :, 1]))


def test_series_do_not_feel_each_other() -> None:
    case = draw_case(10, 4, 2, series=5, lost=0.3)
    together = filtered(case)
    for s in range(5):
        alone = filtered(case._replace(z=case.z[s : s + 1]))
        np.testing.assert_allclose(together.filtered[s], alone.filtered[0], rtol=1e-12, atol=1e-13)


def test_series_with_the_same_losses_share_their_gains() -> None:
    case = draw_case(11, 2, 1, series=6)
    case.z[3:, 4] = np.nan
    run = filtered(case)
    assert run.gains.K.shape[0] == 2
    assert run.pattern.tolist() in ([0, 0, 0, 1, 1, 1], [1, 1, 1, 0, 0, 0])


def test_nees_and_nis_are_consistent() -> None:
    """Their sums over independent records are chi-squared; two-sided bounds of 1e-6."""
    case = draw_case(12, 4, 2)
    random, series = np.random.default_rng(0), 2000
    truth, z = simulate(case.model, case.mean, case.covariance, None, series, 30, random)
    z[random.random(z.shape) < 0.3] = np.nan
    run = run_filter(case.model, z, state=case.mean, covariance=case.covariance)
    error = run.filtered[:, -1] - truth[:, -1]
    nees = np.einsum("si,sij,sj->", error, np.linalg.inv(run.covariance[:, -1]), error)
    for value, freedom in ((nees, 4 * series), (np.sum(run.nis), np.isfinite(z).sum())):
        low, high = chi2.ppf([5e-7, 1 - 5e-7], freedom)
        assert low < value < high


GOOD = {"F": np.eye(2), "Q": np.eye(2), "H": np.ones((1, 2)), "R": np.eye(1)}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"F": np.eye(3)}, r"Q: has the shape \(2, 2\); 3 states and 1 measurements need \(3, 3\)"),
        ({"H": np.ones(2)}, "H: has 1 axes"),
        ({"B": np.ones((3, 1))}, r"B: has the shape \(3, 1\)"),
        ({"Q": np.diag([1.0, -1.0])}, "Q: has the negative eigenvalue -1"),
        ({"Q": np.triu(np.ones((2, 2)))}, "Q: is not symmetric"),
        ({"R": np.full((1, 1), np.inf)}, "R: not all of its numbers are finite"),
        ({"F": np.ones((4, 2, 2)), "R": np.ones((5, 1, 1))}, "F for 4, R for 5"),
    ],
)
def test_models_that_cannot_be(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        LinearModel(**{**GOOD, **changes})
    assert "\n" not in str(caught.value)


Z = np.zeros((1, 6, 1))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda m: run_filter(m, Z[0], state=np.zeros(2), covariance=np.eye(2)), "measurements"),
        (lambda m: run_filter(m, Z + np.inf, state=np.zeros(2), covariance=np.eye(2)), "infinite"),
        (lambda m: run_filter(m, Z, state=np.zeros(3), covariance=np.eye(2)), "state"),
        (lambda m: run_filter(m, Z, state=np.zeros(2), covariance=-np.eye(2)), "covariance"),
        (lambda m: run_filter(m, Z, state=np.zeros(2), covariance=np.eye(3)), "covariance"),
        (
            lambda m: run_filter(
                m, Z, state=np.zeros(2), covariance=np.eye(2), inputs=np.zeros((6, 1))
            ),
            "inputs: the model has no B",
        ),
    ],
)
def test_data_that_do_not_fit(call: Callable[[LinearModel], Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        call(LinearModel(**GOOD))


def test_what_is_known_exactly_and_measured_without_noise_is_refused() -> None:
    model = LinearModel(np.eye(2), np.zeros((2, 2)), np.ones((1, 2)), np.zeros((1, 1)))
    with pytest.raises(InputError, match="R: a measurement without noise"):
        run_filter(model, Z, state=np.zeros(2), covariance=np.zeros((2, 2)))


def test_a_record_longer_than_its_model() -> None:
    model = LinearModel(**{**GOOD, "F": np.ones((4, 2, 2))})
    with pytest.raises(InputError, match="6 steps are more than the 4 of the model"):
        run_filter(model, Z, state=np.zeros(2), covariance=np.eye(2))
