"""SKFA, which tracks the motion: its forms agree, and it comes near to what SKF is told."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tools import Streaming, assert_same, configure, measured

from owtsweep.motion.tracking import Candidate, SpectrumTracker
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.contract import Known
from owtsweep.studies.hub.listed import resolve
from owtsweep.studies.hub.records import make_records_at
from owtsweep.studies.hub.sensors import observe
from owtsweep.studies.hub.spectral_filter import CompiledAxisFilter, KalmanAxisFilter
from owtsweep.studies.hub.tracked_models import make_candidate
from owtsweep.studies.hub.tracking_filter import TrackingFilter
from owtsweep.testing.hub_schemes import check_hub_scheme

SKFA: Any = resolve("SKFA")
BAND = (0.05, 0.6)


def arrive(data: Any, sensors: Any) -> Any:
    """Return the fixes (steps, 2), NaN at steps without one."""
    fixes = np.full((len(data.specific_force), 2), np.nan)
    fixes[:: sensors.fix_interval] = data.fixes
    return fixes


@pytest.mark.usefixtures("kernels")
def test_skfa_keeps_the_contract_step_by_step_and_online() -> None:
    config = configure()
    check_hub_scheme(SKFA, config)
    check_hub_scheme(Streaming(SKFA), config)


@pytest.mark.usefixtures("kernels")
def test_the_compiled_form_gives_what_the_reference_gives_with_fixes_lost() -> None:
    config = configure("record.duration=75", "sensors.imu.rate=20", "sensors.imu.tilt=0.02")
    data, sensors = measured(config)
    fixes = arrive(data, sensors)
    for lost in ([], [47, 48, 49]):
        fixes[[number * sensors.fix_interval for number in lost]] = np.nan
        given = data.specific_force, fixes
        reference = SKFA.start(Known(sensors, config)).run_record(*given)
        compiled = SKFA.stream(Known(sensors, config))
        out = compiled.run_record(*given)
        assert_same(out.state, reference.state, f"fixes {lost} lost")
        np.testing.assert_allclose(out.covariance, reference.covariance, rtol=1e-7, atol=1e-13)
        single = SKFA.stream(Known(sensors, config))
        for k in range(len(out.state)):
            estimate = single.update(given[0][k], None if np.isnan(fixes[k, 0]) else fixes[k])
        np.testing.assert_allclose(estimate.position, out.state[-1, :2], rtol=1e-12)


@pytest.mark.usefixtures("kernels")
def test_gains_grow_with_the_record(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("owtsweep.estimation.late.CHUNK", 128)
    config = configure("sensors.imu.rate=20")
    sensors = sensing.sensors(config.sensors)
    axis = make_candidate(Candidate(8, 0, 8), 0.01, config.skf, sensors, BAND)
    rng = np.random.default_rng(1)
    force, fixes = rng.standard_normal(900), np.full(900, np.nan)
    fixes[:: sensors.fix_interval] = rng.standard_normal(900 // sensors.fix_interval)
    compiled, kalman = CompiledAxisFilter(axis, 0.03), KalmanAxisFilter(axis, 0.03)
    for first, stop in ((0, 90), (90, 500), (500, 900)):
        mine = compiled.take(force[first:stop], fixes[first:stop])
        other = kalman.take(force[first:stop], fixes[first:stop])
        np.testing.assert_allclose(mine.state, other.state, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(mine.covariance, other.covariance, rtol=1e-7, atol=1e-14)
    assert compiled.bias == pytest.approx(kalman.bias, rel=1e-9)


def run(config: Any, amplitude: float, count: int = 3) -> tuple[Any, Any, float]:
    """Return the estimators, mean square position errors after 120 s, and the mean of NEES / 4."""
    records = make_records_at(config, {"natural_period": 4.0}, list(range(count)))
    sensors, first = records.sensors, round(120.0 / records.sensors.step)
    estimators, squares, nees = [], [], []
    for motion, noise in zip(records.motion, records.noise, strict=True):
        seen = observe(motion, records.direction, sensors)
        estimator = SKFA.stream(Known(sensors, config))
        fixes = np.full((len(seen.specific_force), 2), np.nan)
        fixes[:: sensors.fix_interval] = amplitude * seen.fixes + noise.fixes
        out = estimator.run_record(amplitude * seen.specific_force + noise.specific_force, fixes)
        along = (motion.position, motion.velocity)
        truth = np.concatenate([np.outer(each, records.direction) for each in along], axis=1)
        error = (out.state - amplitude * truth)[first:]
        squares.append(np.mean(np.sum(error[:, :2] ** 2, axis=1)))
        weighted = np.linalg.solve(out.covariance[first:], error[..., None])[..., 0]
        nees.append(np.mean(np.sum(error * weighted, axis=1)) / 4.0)
        estimators.append(estimator)
    return estimators, np.mean(squares), float(np.mean(nees))


@pytest.mark.usefixtures("kernels")
def test_without_being_told_it_comes_near_to_what_the_spectrum_allows() -> None:
    config = configure("sensors=strong_bias", "record.duration=500", "sensors.imu.rate=20")
    small, large = (run(config, amplitude) for amplitude in (0.1, 3.0))
    # at 20 Hz, an estimator that assumes nothing has a bound of .0043 m^2
    assert small[1] < 0.15 * large[1]
    for _, _, nees in (small, large):
        assert 0.8 < nees < 1.3
    for filter in small[0][0]._filters:
        assert filter.model.values[0] == pytest.approx(4.0, rel=0.1)


@pytest.mark.usefixtures("kernels")
def test_the_guard_gives_up_a_model_that_fixes_contradict() -> None:
    config = configure("sensors.imu.rate=20")
    sensors = sensing.sensors(config.sensors)
    rng = np.random.default_rng(2)
    tracking = TrackingFilter(config.skf, sensors, BAND, CompiledAxisFilter)
    steps, M = 2400, sensors.fix_interval
    calm = 0.15 * rng.standard_normal(steps)  # an IMU that feels no motion
    still, swinging = np.full((2, steps), np.nan)
    still[::M] = 0.03 * rng.standard_normal(steps // M)
    swinging[::M] = still[::M] + np.where(np.arange(steps // M) % 8 < 4, 1.0, -1.0)
    tracking.take(calm, still)
    assert tracking.model is not None
    tracking.take(calm, swinging)
    assert tracking.model is None
    tracking.take(np.tile(calm, 2), np.tile(still, 2))
    assert tracking.model is not None  # it is tried again at every look


@pytest.mark.usefixtures("kernels")
def test_a_calm_hub_that_is_struck_is_followed_at_once() -> None:
    config = configure("sensors.imu.rate=20")
    sensors = sensing.sensors(config.sensors)
    rng = np.random.default_rng(5)
    tracking = TrackingFilter(config.skf, sensors, BAND, CompiledAxisFilter)
    steps, M = 1200, sensors.fix_interval
    force, fixes = 0.15 * rng.standard_normal(steps), np.full(steps, np.nan)
    fixes[::M] = 0.03 * rng.standard_normal(steps // M)
    tracking.take(force, fixes)
    assert tracking.model is not None
    struck = force[:100].copy()
    struck[63:] += 3.0
    tracking.take(struck[:63], fixes[:63])
    assert tracking.model is not None
    last = tracking.take(struck[63:64], fixes[63:64])  # the sample itself still counts as calm
    assert tracking.model is None
    after = tracking.take(struck[64:65], fixes[64:65])
    assert after.covariance[-1, 0, 0] > 5.0 * last.covariance[-1, 0, 0]


def test_motion_above_the_band_is_measured() -> None:
    time = 0.01 * np.arange(6000)
    swing = 0.05 * np.sin(2.0 * np.pi * 1.7 * time)
    force = -((2.0 * np.pi * 1.7) ** 2) * swing
    tracker = SpectrumTracker(0.01, 0.0, 0.0, BAND)
    above = tracker.measure_above(tracker.average(force))
    # averaging over .1 s takes 10 % of the variance at 1.7 Hz
    assert above.position == pytest.approx(np.var(swing), rel=0.12)
    assert above.velocity == pytest.approx(np.var(swing) * (2.0 * np.pi * 1.7) ** 2, rel=0.12)
    below = 0.05 * np.sin(2.0 * np.pi * 0.3 * time) * -((2.0 * np.pi * 0.3) ** 2)
    assert tracker.measure_above(tracker.average(below)).velocity < 1e-9


def test_records_without_time_for_a_look_are_warned_of(caplog: pytest.LogCaptureFixture) -> None:
    configure("schemes=[SKFA]", "record.duration=29", "measures.settling_time=5")
    assert "schemes: SKFA chooses a spectrum after 30 s; records of 29 s" in caplog.text
