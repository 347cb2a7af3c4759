"""TRAC, FRAC, errors and lag: definitions by plain sums, invariants, and shifted signals."""

import numpy as np
import pytest

from owtsweep.evaluation.signals import (
    compute_frac,
    compute_mae,
    compute_rms_error,
    compute_trac,
    divide_by_deviation,
    find_lag,
)


def make_signals(steps: int = 1000) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(3)
    truth = random.normal(loc=[0.0, 5.0, -2.0], size=(steps, 3))
    return truth, 0.7 * truth + random.normal(scale=0.5, size=(steps, 3))


def test_trac_is_the_printed_quotient_and_the_square_of_the_correlation():
    truth, estimate = make_signals()
    plain = [(a @ b) ** 2 / ((a @ a) * (b @ b)) for a, b in zip(truth.T, estimate.T, strict=True)]
    np.testing.assert_allclose(compute_trac(truth, estimate), plain, rtol=1e-12)
    squares = [np.corrcoef(a, b)[0, 1] ** 2 for a, b in zip(truth.T, estimate.T, strict=True)]
    np.testing.assert_allclose(compute_trac(truth, estimate, centred=True), squares, rtol=1e-12)
    # with a large mean the printed one says little
    assert compute_trac(truth, estimate)[1] > 0.97 > 0.7 > compute_trac(truth, estimate)[0]


def test_trac_is_blind_to_scale_and_sign_but_not_to_the_mean():
    truth, estimate = make_signals()
    trac = compute_trac(truth, estimate)
    np.testing.assert_allclose(compute_trac(truth, -30.0 * estimate), trac, rtol=1e-12)
    np.testing.assert_allclose(compute_trac(estimate, truth), trac, rtol=1e-12)
    np.testing.assert_allclose(compute_trac(truth, 1e200 * truth / 1e90), 1.0, rtol=1e-12)
    assert abs(compute_trac(truth, estimate + 9.0) - trac).max() > 0.1
    centred = compute_trac(truth, estimate, centred=True)
    np.testing.assert_allclose(compute_trac(truth, estimate + 9.0, centred=True), centred)
    time = np.arange(400)
    assert compute_trac(np.sin(0.05 * np.pi * time), np.cos(0.05 * np.pi * time)) < 1e-20


@pytest.mark.parametrize("steps", [1000, 1001])
def test_frac_as_printed_is_trac_and_by_magnitudes_is_not(steps):
    truth, estimate = make_signals(steps)
    a, b = np.fft.fft(truth, axis=0), np.fft.fft(estimate, axis=0)

    def compare(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        def product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
            return np.abs(np.sum(np.conj(p) * q, axis=0))

        return product(x, y) ** 2 / (product(x, x) * product(y, y))

    trac, frac = compute_trac(truth, estimate), compute_frac(truth, estimate)
    np.testing.assert_allclose(compare(a, b), trac, rtol=1e-12)  # Parseval
    np.testing.assert_allclose(frac, compare(np.abs(a), np.abs(b)), rtol=1e-12)
    assert (frac > trac + 1e-3).any()
    assert (frac >= trac).all()


def test_frac_is_blind_to_time_shift_and_reversal():
    truth, _ = make_signals()
    for other in (np.roll(truth, 137, axis=0), truth[::-1]):
        np.testing.assert_allclose(compute_frac(truth, other), 1.0, rtol=1e-12)
        assert (compute_trac(truth, other, centred=True) < 0.1).all()


def test_errors_by_hand():
    truth = np.array([[0.0, 1.0], [2.0, 1.0], [4.0, 1.0], [2.0, 1.0]])
    estimate = truth + np.array([[1.0, 0.5], [-1.0, 0.5], [3.0, 0.5], [1.0, 0.5]])
    np.testing.assert_allclose(compute_mae(truth, estimate), [1.5, 0.5])
    np.testing.assert_allclose(compute_rms_error(truth, estimate), [np.sqrt(3.0), 0.5])
    relative = divide_by_deviation(compute_mae(truth, estimate), truth)
    assert relative[0] == pytest.approx(1.5 / np.sqrt(2.0))
    assert np.isnan(relative[1])  # a constant truth has no deviation


def test_one_signal_gives_one_number():
    truth, estimate = make_signals()
    for compute in (compute_trac, compute_frac, compute_mae, compute_rms_error):
        alone = compute(truth[:, 1], estimate[:, 1])
        assert alone.shape == ()
        assert alone == pytest.approx(compute(truth, estimate)[1], rel=1e-13)
    assert divide_by_deviation(np.array(2.0), truth[:, 1]).shape == ()
    assert find_lag(truth[:, 1], estimate[:, 1], 0.01, 1.0).shape == ()


def test_zero_and_constant_signals_have_no_criterion():
    truth, _ = make_signals()
    nothing, constant = np.zeros_like(truth), np.full_like(truth, 0.1)
    for first, second in ((truth, nothing), (nothing, truth), (nothing, nothing)):
        assert np.isnan(compute_trac(first, second)).all()
        assert np.isnan(compute_frac(first, second)).all()
    assert not np.isnan(compute_trac(truth, constant)).any()
    assert np.isnan(compute_trac(truth, constant, centred=True)).all()
    assert np.isnan(find_lag(truth, constant, 0.01, 1.0)).all()
    assert np.isnan(find_lag(constant, truth, 0.01, 1.0)).all()


def make_smooth(shift: float, steps: int = 6000, step: float = 0.01) -> np.ndarray:
    """Return a signal of many periods, from 1 to 20 s, that is late by `shift` seconds."""
    random = np.random.default_rng(4)
    frequencies = random.uniform(0.05, 1.0, 60)
    phases = random.uniform(0.0, 2.0 * np.pi, 60)
    time = step * np.arange(steps) - shift
    return np.sin(2.0 * np.pi * frequencies * time[:, None] + phases).sum(axis=1)


@pytest.mark.parametrize("shift", [0.0, 0.14, 0.0137, -0.0963, 1.2345, -3.0])
def test_the_lag_of_a_shifted_signal_is_found_between_samples(shift):
    truth, late = make_smooth(0.0), make_smooth(shift)
    # a few hundredths of a sampling interval: the ends of both signals differ
    assert find_lag(truth, late, 0.01) == pytest.approx(shift, abs=1e-3)
    assert find_lag(truth, 100.0 - 30.0 + 2.0 * late, 0.01) == pytest.approx(shift, abs=1e-3)
    both = find_lag(np.stack([truth, late], 1), np.stack([late, truth], 1), 0.01)
    np.testing.assert_allclose(both, [shift, -shift], atol=1e-3)


def find_lag_plainly(truth: np.ndarray, estimate: np.ndarray, most: int) -> float:
    """Return the lag in samples from the correlation of every overlap, one after the other."""
    truth, estimate = truth - truth.mean(), estimate - estimate.mean()
    coefficients = []
    for shift in range(-most, most + 1):
        a = truth[max(-shift, 0) : len(truth) - max(shift, 0)]
        b = estimate[max(shift, 0) : len(truth) - max(-shift, 0)]
        coefficients.append((a @ b) / np.sqrt((a @ a) * (b @ b)))
    best = int(np.argmax(coefficients))
    if best in (0, 2 * most):
        return best - most
    line = np.polyfit([-1.0, 0.0, 1.0], coefficients[best - 1 : best + 2], 2)
    return best - most - line[1] / (2.0 * line[0])


@pytest.mark.parametrize("steps", [64, 81])
def test_lags_of_short_records_agree_with_plain_sums(steps):
    random = np.random.default_rng(9)
    for _ in range(20):
        truth, estimate = random.normal(size=(2, steps)).cumsum(axis=1)
        got = find_lag(truth, estimate, 2.0, 60.0)
        assert got == pytest.approx(2.0 * find_lag_plainly(truth, estimate, 30), abs=1e-8)


def test_the_lag_of_noise_is_the_whole_shift():
    noise = np.random.default_rng(8).normal(size=3000)
    assert find_lag(noise[20:], noise[:-20], 0.5, 100.0) == pytest.approx(10.0, abs=0.05)


def test_a_lag_beyond_the_longest_is_given_as_the_longest():
    truth, late = make_smooth(0.0), make_smooth(0.3)
    assert find_lag(truth, late, 0.01, 0.2) == pytest.approx(0.2)
    assert find_lag(late, truth, 0.01, 0.2) == pytest.approx(-0.2)
