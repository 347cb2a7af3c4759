"""LOWPASS and COMPLEMENTARY against their formulas."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_records import STEP, errors, make, rms, run, tune
from scipy.signal import butter, lfilter
from sine_records import find_lag, report

from owtsweep.estimation.inertial.complementary import blend_acceleration, blend_rate, place_poles
from owtsweep.studies.base.schemes import Unable
from owtsweep.studies.floater.schemes import SCHEMES
from owtsweep.studies.floater.schemes.complementary import find_crossover
from owtsweep.studies.floater.schemes.positions_alone import balance_lag_and_noise

_, SETTING, _ = make()

# LOWPASS


def test_the_low_pass_is_late_by_root_two_over_its_cutoff() -> None:
    cutoff = balance_lag_and_noise(SETTING)
    for column in (0, 4):
        omega = cutoff[column] / 50.0
        periods = 20 * 2.0 * np.pi / omega
        time = STEP * np.arange(round(periods / STEP))
        found = run("LOWPASS", SETTING, report(np.sin(omega * time)))
        lag, size = find_lag(found.position[:, column], np.sin(omega * time), omega)
        assert lag == pytest.approx(np.sqrt(2.0) / cutoff[column], rel=0.01)
        assert size == pytest.approx(1.0, abs=1e-3)
        late, size = find_lag(found.velocity[:, column], omega * np.cos(omega * time), omega)
        assert late - lag == pytest.approx(0.5 * STEP, rel=0.01)
        assert size == pytest.approx(1.0, abs=1e-3)


def test_the_low_pass_halves_the_power_at_its_cutoff_and_follows_a_mean() -> None:
    cutoff = balance_lag_and_noise(SETTING)[1]
    time = STEP * np.arange(8000)
    found = run("LOWPASS", SETTING, report(np.sin(cutoff * time)))
    assert find_lag(found.position[:, 1], np.sin(cutoff * time), cutoff)[1] == pytest.approx(
        np.sqrt(0.5), rel=0.005
    )
    steady = run("LOWPASS", SETTING, report(np.full(50, 8.5)))
    assert steady.position == pytest.approx(8.5)
    assert steady.velocity == pytest.approx(0.0, abs=1e-9)


def test_the_cutoff_balances_lag_and_noise() -> None:
    """The noise of a filtered derivative by brute force; the sum of both errors is least there."""
    step, sigma = 0.001, 0.3
    cutoffs = np.geomspace(0.5, 8.0, 81)
    noise = np.array([
        np.sqrt(np.mean((np.diff(lfilter(*butter(2, w / (2.0 * np.pi), fs=1.0 / step),
                                         np.r_[1.0, np.zeros(29_999)])) / step) ** 2) * 29_999)
        for w in cutoffs
    ]) * sigma  # fmt: skip
    assert noise**2 == pytest.approx(sigma**2 * step * cutoffs**3 / np.sqrt(8.0), rel=0.03)
    total = noise**2 + 2.0 * (0.7 / cutoffs) ** 2
    setting = replace(
        SETTING, step=step, position_sigma=np.full(6, sigma), motion_sigma=np.full((3, 6), 0.7)
    )
    best = cutoffs[np.argmin(total)]
    assert balance_lag_and_noise(setting) == pytest.approx(np.full(6, best), rel=0.05)


# COMPLEMENTARY


@pytest.mark.parametrize("crossover", [0.05, 0.7, 3.0])
def test_poles_are_where_the_crossover_puts_them(crossover: float) -> None:
    """Of the error's matrix (I - K C) F; sampled roots of s^2 + sqrt(2) w s + w^2."""
    alpha, beta = place_poles(crossover, STEP)
    error = np.array([[1.0 - alpha, 0.0], [-beta, 1.0]]) @ [[1.0, STEP], [0.0, 1.0]]
    wanted = np.exp(STEP * np.roots([1.0, np.sqrt(2.0) * crossover, crossover**2]))
    assert np.sort_complex(np.linalg.eigvals(error)) == pytest.approx(np.sort_complex(wanted))


def test_the_crossover_is_that_of_the_noise_and_has_an_end() -> None:
    best = np.sqrt(SETTING.acceleration_sigma / SETTING.position_sigma)
    chosen = SCHEMES.resolve("COMPLEMENTARY").prepare(replace(SETTING, tuning=tune(crossover=3.0)))
    assert chosen.crossover == pytest.approx(3.0 * best)
    fast = SCHEMES.resolve("COMPLEMENTARY").prepare(replace(SETTING, tuning=tune(crossover=1e6)))
    assert fast.crossover == pytest.approx(0.15 * 2.0 * np.pi / STEP)
    body = SCHEMES.resolve("COMPLEMENTARY").prepare(replace(SETTING, body=True))
    assert body.crossover[:3] == pytest.approx(best[:3])
    assert body.crossover[3:] == pytest.approx(SETTING.rate_sigma / SETTING.position_sigma[3:])
    with pytest.raises(Unable, match="accelerations have no noise"):
        SCHEMES.resolve("COMPLEMENTARY").prepare(replace(SETTING, acceleration_sigma=np.zeros(6)))


def test_the_crossover_balances_noise_and_bias() -> None:
    """Against the smallest sum of the three parts, each the gain of the filter it rests on."""
    setting = replace(SETTING, bias_sigma=0.3 * SETTING.acceleration_sigma)
    for i in range(6):
        r, q, b = setting.position_sigma[i], setting.acceleration_sigma[i], setting.bias_sigma[i]
        w = np.geomspace(0.01, 3.0, 20001)
        parts = 1.5 / np.sqrt(2.0) * r**2 * STEP * w, q**2 * STEP / np.sqrt(8.0) / w**3, b**2 / w**4
        assert find_crossover(setting, i) == pytest.approx(w[np.argmin(sum(parts))], rel=1e-3)
    assert find_crossover(setting, 0) > find_crossover(SETTING, 0)


def test_the_best_crossover_is_best_for_white_noise() -> None:
    records = [make(seed, snr=20.0) for seed in range(6)]
    found = []
    for factor in (0.4, 1.0, 2.5):
        square = [
            errors(truth, run("COMPLEMENTARY", replace(s, tuning=tune(crossover=factor)), m)) ** 2
            for truth, s, m in records
        ]
        found.append(np.sqrt(np.mean(square, axis=(0, 1)))[:, 0])
    assert np.all(found[1] < found[0])
    assert np.all(found[1] < found[2])


def test_linear_accelerations_without_noise_are_followed_exactly() -> None:
    """Also where no report comes: then it coasts."""
    time = STEP * np.arange(400)
    position = np.stack([c * time**3 + 2.0 for c in (1.0, -0.3, 0.1, 0.01, 0.02, 0.05)], axis=1)
    acceleration = (position - 2.0) / np.where(time > 0.0, time, 1.0)[:, None] ** 2 * 6.0
    position_with_gap = position.copy()
    position_with_gap[100:300] = np.nan
    found = run("COMPLEMENTARY", SETTING, report(position_with_gap, acceleration=acceleration))
    assert found.position == pytest.approx(position, rel=1e-10)
    speed = np.gradient(position, STEP, axis=0)  # exact but for the cubic's third derivative
    assert found.velocity[1:-1] == pytest.approx(speed[1:-1], abs=1.01 * STEP**2)


def test_waves_without_noise_are_followed_almost_exactly() -> None:
    truth, setting, measured = make(3, noisy=False, mean=2.0)
    error = rms(errors(truth, run("COMPLEMENTARY", setting, measured)))
    assert np.all(error[:, 0] < 1e-3 * truth.position.std(axis=0))
    assert np.all(error[:, 1] < 1e-3 * truth.velocity.std(axis=0))


def test_a_bias_moves_the_position_by_itself_over_the_square_of_the_crossover() -> None:
    crossover, bias = 0.8, 0.01
    gains = place_poles(crossover, STEP)
    estimate = np.empty((4000, 2))
    blend_acceleration(np.zeros(4000), np.full(4000, bias), STEP, gains, 0.0, estimate)
    # What a step adds to the velocity, the report takes away again: beta x- = h b.
    assert estimate[-1, 0] == pytest.approx((1.0 - gains[0]) * STEP * bias / gains[1], rel=1e-9)
    assert estimate[-1, 0] == pytest.approx(bias / crossover**2, rel=0.06)
    assert estimate[-1, 1] == pytest.approx(np.sqrt(2.0) * bias / crossover, rel=0.06)
    turned = np.empty((4000, 2))
    gain = 1.0 - np.exp(-crossover * STEP)
    blend_rate(np.zeros(4000), np.full(4000, bias), STEP, gain, 0.0, turned)
    assert turned[-1, 0] == pytest.approx(bias / crossover, rel=0.03)
