"""The filter whose slow measurement reports the past: gains, estimates and expected errors."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from dense import Measurement, posterior
from numpy.typing import NDArray
from scipy.linalg import block_diag, solve_continuous_lyapunov

from owtsweep.errors import InputError
from owtsweep.estimation import late
from owtsweep.estimation.discretisation import Discrete, Model, discretise
from owtsweep.estimation.late import LateGains, LateModel, LateRows, find_first_covariance
from owtsweep.estimation.weighing import (
    WeighedEstimates,
    WeighedState,
    Weighing,
    follow_weighing,
)
from owtsweep.studies.hub.expected.spectral import find_motion_errors, find_noise_errors

Array = NDArray[np.float64]

STEP, BIAS = 0.1, 0.25
OUTPUTS = np.array([[1.0, 0.0, 0.3, 0.0], [0.0, 1.5, 0.0, 0.6]])
SYSTEM = block_diag([[-0.2, 1.5], [-1.5, -0.2]], [[-0.3, 2.0], [-2.0, -0.3]])
INTENSITY = np.outer([0.0, 1.0, 0.0, 0.5], [0.0, 1.0, 0.0, 0.5])
STATIONARY = solve_continuous_lyapunov(SYSTEM, -INTENSITY)
#: Interval between slow measurements, and their delay: none, short, one interval, several.
PATTERNS = [(5, 0), (5, 3), (5, 5), (4, 10)]


#: No measurement in a row is beyond the limit.
NONE = np.zeros(1, dtype=np.int64)
#: A red noise of 0.3 in the slow measurement, which fades to a fifth in some 50 steps.
RED = {"reds": 1, "fade": 0.97, "red": 0.3**2 * (1.0 - 0.97**2)}


def make(interval: int, delay: int, walk: float = 1e-3) -> LateModel:
    discrete = discretise(Model(SYSTEM, np.zeros((4, 1)), INTENSITY), STEP)
    blocks = np.array([discrete.A[i : i + 2, i : i + 2] for i in (0, 2)])
    fast = np.array([-2.0, 0.5, 0.0, -1.0])
    return LateModel(
        blocks, discrete.Q, walk, fast, OUTPUTS[0], 0.04, 0.01, interval, delay,
        -(-delay // interval),
    )  # fmt: skip


def start(model: LateModel) -> LateGains:
    return LateGains(model, find_first_covariance(model, STATIONARY, BIAS), OUTPUTS)


def tune(model: LateModel, steps: int) -> LateRows:
    return start(model).find(steps)


def run(model: LateModel, gains: LateRows, fast: Array, slow: Array) -> Array:
    """Outputs (steps, 2, series) for fast (steps, series) and slow (fixes, series).

    Past outputs stand in a table by their step, not in a state that is moved on.
    """
    M, series = model.interval, fast.shape[1]
    x, bias = np.zeros((4, series)), np.zeros(series)
    past = {k: np.zeros(series) for k in range(-model.delay, 0)}
    A, result = block_diag(*model.A), []
    for k, u in enumerate(fast):
        count = len(gains.fast)
        at = k if k < count else count - M + (k - count) % M
        waited = [j for j in sorted(past, reverse=True) if (j + model.delay) % M == 0]
        x = A @ x
        for is_slow in (False, True)[: 2 if k % M == 0 else 1]:
            if is_slow:
                gain = gains.slow[at // M]
                old = past[k - model.delay] if model.delay else model.slow @ x
                residual = slow[k // M] - old
            else:
                gain, residual = gains.fast[at], u - model.fast @ x - bias
            x, bias = x + np.outer(gain[:4], residual), bias + gain[4] * residual
            for place, j in enumerate(waited[: model.copies]):
                past[j] = past[j] + gain[5 + place] * residual
        past[k] = model.slow @ x
        result.append(OUTPUTS @ x)
    return np.array(result)


def weigh_all(
    model: LateModel,
    state: WeighedState,
    fast: Array,
    slow: Array,
    rule: Weighing = Weighing(np.inf, False, 0),  # noqa: B008
) -> WeighedEstimates:
    """Run the filter that weighs, on a series (steps,) and its slow measurements (fixes,)."""
    steps = len(fast)
    given = np.full(steps, np.nan)
    given[:: model.interval] = slow
    filled = WeighedEstimates(np.empty((steps, 2)), np.empty((steps, 2, 2)), *np.empty((3, steps)))
    follow_weighing(0, fast, given, model, OUTPUTS, rule, state, filled)
    return filled


def start_weighing(model: LateModel) -> WeighedState:
    first = find_first_covariance(model, STATIONARY, BIAS)
    return WeighedState(np.zeros(len(first)), first, NONE.copy())


@pytest.mark.parametrize(("interval", "delay"), PATTERNS)
def test_with_red_noise_as_a_state_it_is_the_least_squares_too(interval: int, delay: int) -> None:
    """The oracle's state holds the red noise; the same slow measurement is lost in both."""
    model, steps = make(interval, delay)._replace(**RED), 38
    random = np.random.default_rng(4)
    fast, slow = random.normal(size=steps), random.normal(size=-(-steps // interval))
    slow[2] = np.nan
    found = weigh_all(model, start_weighing(model), fast, slow)
    whole = Discrete(
        A=block_diag(*model.A, 1.0, model.fade),
        B=np.zeros((6, 1)),
        Q=block_diag(model.Q, model.walk, model.red),
        step=STEP,
    )
    # here the red noise is that of the output's step; it comes late with it, so all is the same
    measurements = [
        Measurement(k + delay, np.append(model.fast, [1.0, 0.0]), u, model.r_fast)
        for k, u in enumerate(fast)
    ]
    measurements += [
        Measurement(q * interval, np.append(model.slow, [0.0, 1.0]), z, model.r_slow)
        for q, z in enumerate(slow)
        if not np.isnan(z)
    ]
    prior = block_diag(STATIONARY, BIAS - delay * model.walk, 0.3**2)
    dense = posterior(whole, prior, np.zeros((steps + delay, 1)), measurements)
    expected = OUTPUTS @ dense.mean[-1, :4]
    np.testing.assert_allclose(
        found.outputs[-1], expected, rtol=0, atol=1e-8 * np.abs(expected).max()
    )
    covariance = OUTPUTS @ dense.covariance[-1, :4, -1, :4] @ OUTPUTS.T
    np.testing.assert_allclose(found.covariance[-1], covariance, rtol=1e-8)


@pytest.mark.parametrize("red", [{}, RED])
def test_the_filter_that_weighs_gives_what_its_gains_give_if_all_count_alike(
    red: dict[str, float],
) -> None:
    model = make(4, 10)._replace(**red)
    random = np.random.default_rng(5)
    fast, slow = random.normal(size=400), random.normal(size=100)
    gains, lanes = start(model), late.start_lanes(len(start_weighing(model).x), 1)
    found = late.prepare_estimates(400, 100, 1)
    late.follow(0, fast[:, None], slow[:, None], 0, model, OUTPUTS, gains.find(400), lanes, found)
    weighed = weigh_all(model, start_weighing(model), fast, slow)
    np.testing.assert_allclose(weighed.outputs, found.outputs[..., 0], atol=1e-9)
    np.testing.assert_allclose(weighed.covariance, found.covariance, rtol=1e-8, atol=1e-12)
    np.testing.assert_allclose(weighed.innovation[::4], found.innovation[:, 0], atol=1e-9)


def test_a_gate_does_not_lock_itself_out() -> None:
    """Ten offset measurements in a row are refused, then all are taken: the state is wrong."""
    model = make(4, 10)
    fast, slow = np.zeros(200), np.zeros(50)
    slow[20:] = 40.0
    rule = Weighing(3.0, False, 10)
    weight = weigh_all(model, start_weighing(model), fast, slow, rule).weight[::4]
    np.testing.assert_array_equal(weight[20:30], 0.0)
    np.testing.assert_array_equal(weight[30:], 1.0)
    fading = weigh_all(model, start_weighing(model), fast, slow, Weighing(3.0, True, 0))
    distance = np.abs(fading.innovation[80]) / np.sqrt(fading.variance[80])
    assert fading.weight[80] == pytest.approx(3.0 / distance)


@pytest.mark.parametrize(("interval", "delay"), PATTERNS)
def test_an_estimate_is_the_least_squares_of_all_measurements(interval: int, delay: int) -> None:
    model, steps = make(interval, delay), 33
    random = np.random.default_rng(3)
    fast, slow = random.normal(size=steps), random.normal(size=-(-steps // interval))
    gains = tune(model, steps)
    estimated = run(model, gains, fast[:, None], slow[:, None])[-1, :, 0]
    # the oracle's states begin one step before the first output that is reported
    whole = Discrete(
        A=block_diag(*model.A, 1.0),
        B=np.zeros((5, 1)),
        Q=block_diag(model.Q, model.walk),
        step=STEP,
    )
    prior = block_diag(STATIONARY, BIAS - delay * model.walk)
    measurements = [
        Measurement(k + delay, np.append(model.fast, 1.0), u, model.r_fast)
        for k, u in enumerate(fast)
    ]
    measurements += [
        Measurement(q * interval, np.append(model.slow, 0.0), z, model.r_slow)
        for q, z in enumerate(slow)
    ]
    dense = posterior(whole, prior, np.zeros((steps + delay, 1)), measurements)
    expected = OUTPUTS @ dense.mean[-1, :4]
    np.testing.assert_allclose(estimated, expected, rtol=0, atol=1e-8 * np.abs(expected).max())
    covariance = OUTPUTS @ dense.covariance[-1, :4, -1, :4] @ OUTPUTS.T
    np.testing.assert_allclose(gains.outputs[steps - 1], covariance, rtol=1e-8)


@pytest.mark.parametrize(("interval", "delay"), PATTERNS)
def test_gains_repeat_once_they_have_settled(interval: int, delay: int) -> None:
    model = make(interval, delay)
    gains = start(model)
    rows = gains.find(10**5)
    assert gains.repeats
    assert len(rows.fast) < 10**5
    assert len(rows.fast) % interval == 0
    np.testing.assert_allclose(
        rows.outputs[-interval:], rows.outputs[-2 * interval : -interval], rtol=1e-9
    )


def test_gains_are_those_of_one_attempt_if_it_takes_several(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    model = make(4, 10)
    whole = tune(model, 10**5)
    monkeypatch.setattr(late, "CHUNK", 21)
    pieces = tune(model, 10**5)
    assert len(whole.fast) > 42
    for piece, array in zip(pieces, whole, strict=True):
        np.testing.assert_array_equal(piece, array)


def test_threads_that_share_gains_find_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(late, "CHUNK", 256)
    model, steps = make(64, 10), range(500, 30_000, 500)
    monkeypatch.setattr(late, "TOLERANCE", 0.0)  # so that they never repeat
    whole, shared = tune(model, steps[-1]), start(model)
    with ThreadPoolExecutor(4) as pool:
        for step, found in zip(steps, pool.map(shared.find, steps), strict=True):
            np.testing.assert_array_equal(found.fast[:step], whole.fast[:step])


@pytest.mark.parametrize(("interval", "delay"), PATTERNS)
def test_the_covariance_at_a_step_is_that_of_the_gains_there(
    interval: int, delay: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(late, "CHUNK", 21)
    gains = start(make(interval, delay))
    for step in (0, 4 * interval, 13 * interval, 10**4 * interval):
        rows = gains.find(step + interval)
        at = step if step < len(rows.fast) else len(rows.fast) - interval
        state = WeighedState(np.zeros(5 + gains.model.copies), gains.find_covariance(step), NONE)
        found = weigh_all(gains.model, state, np.zeros(interval), np.zeros(1))
        np.testing.assert_allclose(found.covariance, rows.outputs[at : at + interval], rtol=1e-9)


@pytest.mark.parametrize(("interval", "delay"), PATTERNS)
def test_errors_from_motion_are_those_of_a_long_sinusoid(interval: int, delay: int) -> None:
    model = make(interval, delay)
    gains, omega, lean = tune(model, 10**5), np.array([0.7, 1.9, 4.0]), 0.3
    found = find_motion_errors(model, gains, OUTPUTS, (omega, -(omega**2) - lean + 0j, STEP))
    steps = 3_000 // interval * interval
    # both phases, so that the mean over a few periods is the mean over all
    wave = np.exp(1j * omega * STEP * np.arange(-delay, steps)[:, None])
    motion = np.concatenate([wave.real, wave.imag], axis=1)
    double = np.tile(omega, 2)
    fast, slow = -(double**2 + lean) * motion[delay:], motion[:steps:interval]
    moving = np.concatenate([-wave.imag, wave.real], axis=1)[delay:] * double
    error = run(model, gains, fast, slow) - np.stack([motion[delay:], moving], axis=1)
    settled = error[-40 * interval :]
    summed = np.sum(np.mean(settled**2, axis=0).reshape(2, 2, 3), axis=1)
    np.testing.assert_allclose(found, summed, rtol=1e-6)


@pytest.mark.parametrize(("interval", "delay"), PATTERNS)
def test_errors_from_noise_are_the_sum_of_all_single_errors(interval: int, delay: int) -> None:
    model = make(interval, delay, walk=0.01)
    gains, steps = tune(model, 10**5), 300 // interval * interval
    # unit errors of each sample, unit steps of the bias, unit errors of each fix
    fixes = steps // interval
    inputs = np.zeros((steps, 2 * steps + fixes))
    inputs[:, :steps] = np.eye(steps)
    inputs[:, steps : 2 * steps] = np.tril(np.ones((steps, steps)))
    slow = np.zeros((fixes, 2 * steps + fixes))
    slow[:, 2 * steps :] = np.eye(fixes)
    settled = LateRows(
        gains.fast[-interval:], gains.slow[-1:], gains.variance[-1:], gains.outputs[-interval:]
    )
    error = run(model, settled, inputs, slow)[-interval:]
    white, walked, late = np.split(np.mean(error**2, axis=0), [steps, 2 * steps], axis=1)
    noise = (0.05, 0.02, 0.03)
    expected = noise[0] * white.sum(1) + noise[2] * walked.sum(1) + noise[1] * late.sum(1)
    np.testing.assert_allclose(find_noise_errors(model, gains, OUTPUTS, noise), expected, rtol=1e-6)


def test_a_bias_without_a_walk_has_no_settled_error() -> None:
    model = make(5, 3, walk=0.0)
    with pytest.raises(InputError, match=r"skf.q_b: without a bias walk"):
        find_noise_errors(model, tune(model, 100), OUTPUTS, (1.0, 1.0, 0.0))
