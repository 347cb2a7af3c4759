"""The floater study's Kalman filters against other packages and dense least squares."""

from dataclasses import replace

import numpy as np
import pytest
from linear_records import (
    STEP,
    continuous,
    lose,
    losses,
    make,
    rms,
    run,
    tune,
)
from scipy.linalg import expm, solve_discrete_are

from owtsweep.estimation.kinematic import Noise, State, predict
from owtsweep.estimation.kinematic_predictor import make_noise, make_transition


def twelve(setting):
    """Return A_d, B_d, C_d, Q and R of Eqs. (8) to (10) with all 12 states."""
    A = np.kron(make_transition(STEP), np.eye(6))
    B = np.kron([[STEP**2 / 2.0], [STEP]], np.eye(6))
    C = np.eye(12)[[0, 1, 2, 3, 4, 5, 9, 10, 11]]
    G = np.block([[STEP * np.eye(6), STEP**2 / 2.0 * np.eye(6)],
                  [np.zeros((6, 6)), STEP * np.eye(6)]])  # fmt: skip
    Q = G @ np.diag(np.tile(setting.acceleration_sigma**2, 2)) @ G.T
    R = np.diag(np.concatenate([setting.position_sigma, setting.rate_sigma]) ** 2)
    return A, B, C, Q, R


def test_printed_filter_equals_twelve_states_of_filterpy():
    from filterpy.kalman import KalmanFilter

    _, setting, measured = make(steps=400)
    measured = lose(measured, losses(400, np.random.default_rng(3)), zeros=False)
    found = run("KF", setting, measured)
    A, B, C, Q, R = twelve(setting)
    peer = KalmanFilter(dim_x=12, dim_z=9, dim_u=6)
    peer.F, peer.B, peer.H, peer.Q, peer.R = A, B, C, Q, R
    peer.x = np.concatenate([measured.position[0], np.zeros(6)])[:, None]
    peer.P = np.diag(np.concatenate([setting.position_sigma, setting.motion_sigma[1]]) ** 2)
    for k in range(400):
        assert np.allclose(peer.x[:6, 0], found.position[k], rtol=1e-9, atol=1e-9)
        assert np.allclose(peer.x[6:, 0], found.velocity[k], rtol=1e-9, atol=1e-9)
        variances = found.covariance[k][:, [0, 1], [0, 1]].T.ravel()
        assert np.allclose(np.diag(peer.P), variances, rtol=1e-9, atol=0.0)
        if measured.lost[k]:
            peer.update(measured.rate[k][:, None], R=R[6:, 6:], H=C[6:])
        else:
            z = np.concatenate([measured.position[k], measured.rate[k]])
            peer.update(z[:, None])
        peer.predict(measured.acceleration[k][:, None])


def test_steady_gains_are_those_of_twelve_states():
    _, setting, measured = make(steps=300)
    A, B, C, Q, R = twelve(setting)
    P = solve_discrete_are(A.T, C.T, Q, R)
    K = A @ P @ C.T @ np.linalg.inv(C @ P @ C.T + R)
    found = run("KF_STEADY", setting, measured)
    x = np.concatenate([measured.position[0], np.zeros(6)])
    for k in range(300):
        assert np.allclose(np.concatenate([found.position[k], found.velocity[k]]), x, atol=1e-7)
        z = np.concatenate([measured.position[k], measured.rate[k]])
        x = A @ x + B @ measured.acceleration[k] + K @ (z - C @ x)
    assert np.allclose(found.covariance[0, :, 0, 0], np.diag(P)[:6], rtol=1e-6)


def test_prediction_is_that_of_the_continuous_model():
    noise = Noise(0.3, 0.2, 1.0, 1.0)
    root = np.random.default_rng(0).standard_normal((3, 3))
    P, x = root @ root.T, np.array([1.0, -2.0, 0.5])
    s = predict(State(*x, *P[np.triu_indices(3)]), 0.7, 3.0, -1.0, noise)
    F, falling, rising, Q = continuous(noise, 0.7)
    assert np.allclose(s[:3], F @ x + 3.0 * falling - 1.0 * rising, rtol=1e-12)
    assert np.allclose(s[3:], (F @ P @ F.T + Q)[np.triu_indices(3)], rtol=1e-12)


@pytest.mark.parametrize("name", ["KF_CONSISTENT", "KF_BIAS"])
def test_consistent_filter_equals_statsmodels_with_missing_rows(name):
    from statsmodels.tsa.statespace.kalman_filter import KalmanFilter

    steps = 400
    _, setting, measured = make(steps=steps, bias=0.1)
    setting = replace(setting, bias_walk=0.1 * setting.bias_sigma)
    measured = lose(measured, losses(steps, np.random.default_rng(3)), zeros=False)
    found = run(name, setting, measured)
    for c in (0, 4):
        bias = name == "KF_BIAS"
        noise = Noise(
            setting.acceleration_sigma[c] ** 2 * STEP, bias * setting.bias_walk[c] ** 2, 1.0, 1.0
        )
        F, falling, rising, Q = continuous(noise, STEP)
        a = measured.acceleration[:, c]
        rows = [measured.position[:, c]] + [measured.rate[:, 1]] * (c == 4)
        H = np.eye(3)[: len(rows)]
        variances = [setting.position_sigma[c] ** 2, setting.rate_sigma[1] ** 2][: len(rows)]
        peer = KalmanFilter(k_endog=len(rows), k_states=3, tolerance=0.0)
        peer.bind(np.array(rows)[:, 1:].T.copy())
        peer["design"], peer["transition"], peer["selection"] = H, F, np.eye(3)
        peer["obs_cov"], peer["state_cov"] = np.diag(variances), Q
        push = np.outer(falling, a[:-1]) + np.outer(rising, a[1:])  # from k to k + 1
        peer["state_intercept"] = np.column_stack([push[:, 1:], np.zeros(3)])
        x0 = np.array([measured.position[0, c], 0.0, 0.0])
        P0 = np.diag([variances[0], setting.motion_sigma[1, c] ** 2,
                      bias * setting.bias_sigma[c] ** 2])  # fmt: skip
        peer.initialize_known(F @ x0 + push[:, 0], F @ P0 @ F.T + Q)
        theirs = peer.filter()
        size = rms(theirs.filtered_state[0])
        assert np.allclose(found.position[1:, c], theirs.filtered_state[0], atol=1e-9 * size)
        assert np.allclose(found.velocity[1:, c], theirs.filtered_state[1], atol=1e-9 * size)
        P = np.moveaxis(theirs.filtered_state_cov[:2, :2], -1, 0)
        assert np.allclose(found.covariance[1:, c], P, rtol=1e-7, atol=1e-9 * P[0, 0, 0])
        # Both rows correct together there, one after the other here: positions first see the same.
        e = theirs.forecasts_error[0] ** 2 / theirs.forecasts_error_cov[0, 0]
        lost = measured.lost[1:]
        assert np.all(np.isnan(found.nis[1:, c]) == lost)
        if c == 0:
            assert np.allclose(found.nis[1:, c][~lost], e[~lost], rtol=1e-6)


def dense(setting, measured, column, age, heard, rates):
    """Return mean and covariance of all samples' states by dense least squares.

    Used are the reports `heard` and the rates of the samples `rates`. States are those of all
    samples and of all times that reports show, tied by the process noise; the first report used is
    the prior.
    """
    steps = len(age)
    noise = Noise(setting.acceleration_sigma[column] ** 2 * STEP, setting.bias_walk[column] ** 2,
                  setting.position_sigma[column] ** 2, 1.0)  # fmt: skip
    shown = np.round(np.arange(steps) - age / STEP, 9)
    first = heard[0]
    times = np.unique(np.concatenate([shown[heard], np.arange(np.ceil(shown[first]), steps)]))
    a = np.interp(times, np.arange(steps), measured.acceleration[:, column])
    rows, goals = [], []

    def add(at, row, goal, covariance):
        full = np.zeros((len(row), 3 * len(times)))
        for index, part in zip(at, np.split(row, len(at), axis=1), strict=True):
            full[:, 3 * index : 3 * index + 3] = part
        root = np.linalg.inv(np.linalg.cholesky(covariance))
        rows.append(root @ full)
        goals.append(root @ np.atleast_1d(goal))

    prior = [noise.position, setting.motion_sigma[1, column] ** 2, setting.bias_sigma[column] ** 2]
    add([0], np.eye(3), [measured.position[first, column], 0.0, 0.0], np.diag(prior))
    for i in range(1, len(times)):
        F, falling, rising, Q = continuous(noise, (times[i] - times[i - 1]) * STEP)
        push = falling * a[i - 1] + rising * a[i]
        add([i - 1, i], np.hstack([-F, np.eye(3)]), push, Q)
    for k in heard[1:]:
        i = np.searchsorted(times, shown[k])
        add([i], np.eye(3)[:1], measured.position[k, column], np.array([[noise.position]]))
    for k in rates if column > 2 else []:
        if k > shown[first]:
            i = np.searchsorted(times, k)
            variance = np.array([[setting.rate_sigma[column - 3] ** 2]])
            add([i], np.eye(3)[1:2], measured.rate[k, column - 3], variance)
    J, goal = np.vstack(rows), np.concatenate(goals)
    scale = 1.0 / np.linalg.norm(J, axis=0)
    q, r = np.linalg.qr(J * scale)
    inverse = np.linalg.inv(r) * scale[:, None]
    x = inverse @ (q.T @ goal)
    return times, x.reshape(-1, 3), inverse @ inverse.T


def posterior(setting, measured, column, sample, now, rates):
    """Return position and velocity of a sample and their covariance, from what came until `now`."""
    arrived = np.isfinite(measured.position[:, 0]) & (np.arange(len(measured.age)) <= now)
    usable = measured.age <= np.arange(len(measured.age)) * STEP + 1e-9
    heard = np.flatnonzero(arrived & usable)
    times, x, P = dense(setting, measured, column, measured.age, heard, rates)
    i = np.searchsorted(times, sample)
    return x[i, :2], P[3 * i : 3 * i + 2, 3 * i : 3 * i + 2]


@pytest.mark.parametrize("delay", [0.0, 3.0, 2.4])
def test_delayed_filter_and_smoother_equal_dense_least_squares(delay):
    steps, lag = 40, 8
    _, setting, measured = make(steps=steps, delay=delay * STEP, bias=0.3)
    setting = replace(setting, bias_walk=0.1 * setting.bias_sigma, tuning=tune(lag=lag * STEP))
    lost = np.arange(steps) % 7 == 5
    lost[20:25] = True
    measured = lose(measured, lost, zeros=False)
    now = run("KF_REPAIRED", setting, measured)
    later = run("FIXED_LAG", setting, measured)
    assert later.latency == pytest.approx(lag * STEP)
    window = lag - int(delay)
    for column in (1, 5):
        for k in (6, 19, 22, 26, 30):
            x, P = posterior(setting, measured, column, k, k, range(1, k + 1))
            got = [now.position[k, column], now.velocity[k, column]]
            assert np.allclose(got, x, rtol=1e-7, atol=1e-9)
            assert np.allclose(now.covariance[k, column], P, rtol=1e-6, atol=1e-9 * P[0, 0])
            x, P = posterior(setting, measured, column, k, k + lag, range(1, k + window + 1))
            got = [later.position[k, column], later.velocity[k, column]]
            assert np.allclose(got, x, rtol=1e-7, atol=1e-9)
            assert np.allclose(later.covariance[k, column], P, rtol=1e-6, atol=1e-9 * P[0, 0])


def test_lag_shorter_than_the_delay_predicts_by_the_rest():
    _, setting, measured = make(steps=300, delay=5.0 * STEP)
    short = replace(setting, tuning=tune(lag=2.0 * STEP))
    later = run("FIXED_LAG", short, measured)
    sooner = replace(
        measured, position=measured.position[2:], age=measured.age[2:] - 2 * STEP,
        lost=measured.lost[2:], acceleration=measured.acceleration[:-2], rate=measured.rate[:-2],
    )  # fmt: skip
    assert np.allclose(later.position[20:-2], run("KF_REPAIRED", setting, sooner).position[20:])


def test_noise_enters_as_the_right_g_d_says():
    sigma = np.array([2.0, 3.0])
    A, G = np.array([[0.0, 1.0], [0.0, 0.0]]), np.eye(2)
    held = expm(np.block([[A, G], [np.zeros((2, 4))]]) * STEP)[:2, 2:]
    assert np.allclose(make_noise(STEP, sigma), held @ np.diag(sigma**2) @ held.T)
