"""The delay margin by Nyquist's criterion, against eigenvalues of the whole loop."""

from dataclasses import replace

import numpy as np
import pytest
from linear_records import make, tune
from scipy.linalg import expm
from scipy.signal import butter

from experiments.floater import delay_margin
from experiments.floater.delay_margin import Loop, find_margin, record_responses
from owtsweep.studies.floater.schemes.positions_alone import balance_lag_and_noise

STEP, PERIOD, ZETA = 0.25, 12.0, 0.05
W = 2.0 * np.pi / PERIOD
LOOP = Loop(W, ZETA, STEP)


@pytest.fixture
def setting():
    _, made, _ = make(steps=400)
    return replace(
        made, step=STEP, frequency=np.full(6, W), tuning=tune(delay="truth", lag=1.0),
        motion_sigma=np.outer([1.0, W, W**2], np.ones(6)), position_sigma=np.full(6, 0.1),
        acceleration_sigma=np.full(6, 0.1 * W**2), rate_sigma=np.full(3, 0.1 * W),
    )  # fmt: skip


def model(stiffness, damping):
    """Return the matrices of position, velocity, actuator and held force over a step."""
    tau = delay_margin.ACTUATOR
    continuous = np.array([
        [0.0, 1.0, 0.0, 0.0],
        [-(W**2), -2.0 * ZETA * W, 1.0, 0.0],
        [0.0, 0.0, -1.0 / tau, 1.0 / tau],
        [0.0, 0.0, 0.0, 0.0],
    ])  # fmt: skip
    moved = expm(continuous * STEP)
    return moved[:3, :3], moved[:3, 3], continuous[1, :3]


def radius_with_lowpass(setting, delay):
    """Return the spectral radius of the loop with LOWPASS, written as one matrix."""
    cutoff = balance_lag_and_noise(setting)[0] / (2.0 * np.pi)
    b, a = butter(2, cutoff, fs=1.0 / STEP)
    A, B, _ = model(W, W)
    # States: model (3), outputs of the filter (3 old), inputs of the filter (delay + 3 old).
    n, old = 3 + 3 + delay + 3, 6
    M = np.zeros((n, n))
    M[:3, :3] = A
    now = np.zeros(n)  # the report of this sample
    if delay == 0:
        now[0] = 1.0
    else:
        now[old + delay - 1] = 1.0
    shift = np.zeros((delay + 3, n))
    shift[0, 0] = 1.0
    for i in range(1, delay + 3):
        shift[i, old + i - 1] = 1.0
    # Reports one and two samples before this one.
    before = [np.eye(n)[old + delay + i] for i in range(2)]
    filtered = b[0] * now + b[1] * before[0] + b[2] * before[1]
    filtered = filtered - a[1] * np.eye(n)[3] - a[2] * np.eye(n)[4]
    rate = (filtered - np.eye(n)[3]) / STEP
    force = -(delay_margin.STIFFNESS * W**2 * filtered + delay_margin.DAMPING * W * rate)
    M[:3] += np.outer(B, force)
    M[3], M[4], M[5] = filtered, np.eye(n)[3], np.eye(n)[4]
    M[old:] = shift
    return np.abs(np.linalg.eigvals(M)).max()


def test_the_margin_is_where_an_eigenvalue_of_the_loop_leaves_the_unit_circle(setting):
    margin = find_margin("LOWPASS", setting, LOOP)
    unstable = round(margin / STEP)
    assert 1 < unstable < 20
    assert radius_with_lowpass(setting, unstable - 1) < 1.0 < radius_with_lowpass(setting, unstable)


@pytest.mark.parametrize("name", ["KF", "KF_STEADY", "KF_CONSISTENT", "COMPLEMENTARY"])
def test_the_loop_in_time_grows_beyond_the_margin_only(setting, name):
    """Estimates are convolutions of what is measured with the recorded responses."""
    margin = find_margin(name, setting, LOOP)
    sizes = []
    for delay in (round(margin / STEP) - 1, round(margin / STEP)):
        by_report, by_acceleration = record_responses(name, setting, LOOP, delay)
        A, B, push = model(W, W)
        state, steps = np.array([1.0, 0.0, 0.0]), 4000
        q, a = np.zeros(steps), np.zeros(steps)
        for k in range(steps):
            q[k], a[k] = state[0], push @ state
            span = min(k + 1, len(by_report))
            x, v = by_acceleration[:span].T @ a[k::-1][:span] if k else (0.0, 0.0)
            if k >= delay:
                late = q[: k - delay + 1][::-1][:span]
                x, v = np.array([x, v]) + by_report[: len(late)].T @ late
            state = A @ state + B * -(
                delay_margin.STIFFNESS * W**2 * x + delay_margin.DAMPING * W * v
            )
        sizes.append(np.abs(q[-200:]).max() / np.abs(q[2000:2200]).max())
    assert sizes[0] < 1.0 < sizes[1]


def test_who_knows_the_delay_bears_any(setting):
    assert find_margin("KF_DELAY", setting, LOOP) == np.inf
    told = replace(setting, tuning=tune(delay="ignored"))
    assert find_margin("KF_DELAY", told, LOOP) < 5.0


def test_estimates_that_wait_are_late_by_their_wait(setting):
    """What a smoother says of the past is what a filter says of now, carried back."""
    setting = replace(setting, bias_sigma=np.zeros(6))
    late, _ = record_responses("FIXED_LAG", setting, LOOP, 0)
    now, _ = record_responses("KF_REPAIRED", setting, LOOP, 0)
    carried = now[:, 0] - setting.tuning.lag * now[:, 1]
    assert late[:8, 0] == pytest.approx(carried[:8], rel=0.05)
    assert np.all(now[:4, 0] > 1.2 * carried[:4])
