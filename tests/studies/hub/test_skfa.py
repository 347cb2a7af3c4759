"""SKFA, which tracks the motion: its forms agree, and it comes near to what SKF is told."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tools import Streaming, assert_same, configure, measured

from owtsweep.config import changed
from owtsweep.estimation.weighing import ALIKE
from owtsweep.gravity import GRAVITY
from owtsweep.motion.candidates import Candidate
from owtsweep.motion.tracking import SpectrumTracker
from owtsweep.sensing.noise import draw_gauss_markov
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.contract import Known, resolve, under
from owtsweep.studies.hub.fix_noise_tracking import SIZES, FixNoiseTracker, find_level
from owtsweep.studies.hub.models import make_fix_rule
from owtsweep.studies.hub.records import make_records_at
from owtsweep.studies.hub.sensors import observe
from owtsweep.studies.hub.spectral_filter import CompiledAxisFilter, KalmanAxisFilter
from owtsweep.studies.hub.tracked_models import make_sea_model
from owtsweep.studies.hub.tracking_filter import (
    LIKELY,
    LIKELY_WIDE,
    TrackingFilter,
    _is_beaten,
)
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
    axis = make_sea_model(
        (Candidate(8, 0, 8), Candidate(30, 1, 5)), 0.01, config.skf, sensors, BAND
    )
    rng = np.random.default_rng(1)
    force, fixes = rng.standard_normal(900), np.full(900, np.nan)
    fixes[:: sensors.fix_interval] = rng.standard_normal(900 // sensors.fix_interval)
    compiled, kalman = (make(axis, ALIKE, 0.03) for make in (CompiledAxisFilter, KalmanAxisFilter))
    for first, stop in ((0, 90), (90, 500), (500, 900)):
        mine = compiled.take(force[first:stop], fixes[first:stop])
        other = kalman.take(force[first:stop], fixes[first:stop])
        np.testing.assert_allclose(mine.state, other.state, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(mine.covariance, other.covariance, rtol=1e-7, atol=1e-14)
    assert compiled.bias == pytest.approx(kalman.bias, rel=1e-9)


@pytest.mark.usefixtures("kernels")
def test_after_a_lost_fix_the_gains_are_the_models_again() -> None:
    """Where that is does not depend on how a record is cut."""
    config = configure("sensors.imu.rate=20")
    sensors = sensing.sensors(config.sensors)
    axis = make_sea_model((Candidate(14, 1, 8),), 0.01, config.skf, sensors, BAND)
    rng, M = np.random.default_rng(1), sensors.fix_interval
    force, fixes = rng.standard_normal(6000), np.full(6000, np.nan)
    fixes[::M] = rng.standard_normal(len(fixes[::M]))
    fixes[[100 * M, 103 * M]] = np.nan
    whole, cut, kalman = (
        make(axis) for make in (CompiledAxisFilter, CompiledAxisFilter, KalmanAxisFilter)
    )
    found, exact = whole.take(force, fixes), kalman.take(force, fixes)
    weighs = []
    for first in range(0, 6000, 7):
        part = cut.take(force[first : first + 7], fixes[first : first + 7])
        np.testing.assert_array_equal(part.state, found.state[first : first + 7])
        weighs.append(cut._weighed is not None)
    assert weighs.count(True) > 0
    assert weighs[0] == weighs[-1] is False
    sigma = np.sqrt(np.diagonal(exact.covariance, axis1=1, axis2=2))
    assert np.max(np.abs(found.state - exact.state) / sigma) < 1e-5
    assert np.max(np.abs(found.covariance[:, 0, 0] / sigma[:, 0] ** 2 - 1.0)) < 1e-5


@pytest.mark.usefixtures("kernels")
@pytest.mark.parametrize("rule", ["plain", "gate", "huber"])
@pytest.mark.parametrize("scheme", ["SKF", "SKFA"])
def test_batch_equals_online_with_each_rule(scheme: str, rule: str) -> None:
    config = configure(
        "record.duration=75", "sensors.imu.rate=20", "sensors.gnss.outliers.rate=0.1",
        f"skf.fix_rule={rule}", "skf.natural_period=4", "skf.amplitude=1", "skf.states=6",
    )  # fmt: skip
    data, sensors = measured(config)
    fixes, known = arrive(data, sensors), Known(sensors, config)
    fixes[[47 * sensors.fix_interval, 48 * sensors.fix_interval]] = np.nan
    mine: Any = under(resolve(scheme), config)
    assert mine.linear == (scheme == "SKF" and rule == "plain")
    out = mine.stream(known).run_record(data.specific_force, fixes)
    reference = mine.start(known).run_record(data.specific_force, fixes)
    assert_same(out.state, reference.state, f"{scheme} {rule}")
    np.testing.assert_allclose(out.covariance, reference.covariance, rtol=1e-7, atol=1e-13)
    single = mine.stream(known)
    for k in range(len(fixes)):
        estimate = single.update(
            data.specific_force[k], None if np.isnan(fixes[k, 0]) else fixes[k]
        )
        np.testing.assert_allclose(estimate.position, out.state[k, :2], rtol=1e-9, atol=1e-12)


@pytest.mark.usefixtures("kernels")
def test_red_noise_of_fixes_is_found_and_not_taken_for_motion() -> None:
    config = configure(
        "sensors=strong_bias", "record.duration=300", "sensors.imu.rate=20",
        "sensors.gnss.correlation.sigma=0.1", "sensors.gnss.correlation.time=300",
    )  # fmt: skip
    estimators, square, nees = run(config, 0.1)
    tracked = [filter.told.red for estimator in estimators for filter in estimator._filters]
    assert set(tracked) <= {0.03, 0.1, 0.3}
    assert square < 1e-3
    assert nees < 2.0
    declared = changed(config, skf=changed(config.skf, red_sigma=0.0))
    _, untracked, _ = run(declared, 0.1)
    assert square < 0.1 * untracked


def test_the_size_of_red_noise_is_chosen_from_what_fixes_show_below_the_band() -> None:
    rng, count = np.random.default_rng(8), 600
    white = 0.03 * rng.standard_normal(count)
    swing = np.sin(2.0 * np.pi * 0.23 * np.arange(count))
    red = draw_gauss_markov(rng, count, sigma=0.1, time=300.0, step=1.0, axes=1)[:, 0]
    for fixes, sizes in ((white, {0.0}), (white + swing, {0.0}), (white + red + swing, SIZES[1:])):
        fixes[[100, 101]] = np.nan
        tracker = FixNoiseTracker(1.0, 300.0, BAND)
        chosen = [tracker.look(fixes[:stop], 0.03) for stop in range(30, count, 10)]
        assert chosen[0] == 0.0
        assert set(chosen[25:]) <= set(sizes)
    missed = []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        red = draw_gauss_markov(rng, 1200, sigma=0.1, time=300.0, step=1.0, axes=1)[:, 0]
        fixes, tracker = red + 0.03 * rng.standard_normal(1200), FixNoiseTracker(1.0, 300.0, BAND)
        missed += [tracker.look(fixes[:stop], 0.03) < 0.1 for stop in range(240, 1200, 10)]
    assert np.mean(missed) < 0.03  # a size that was seen is not lowered by chance
    # at a fix every 2 s, motion at .5 Hz looks like a standing hub
    assert FixNoiseTracker(2.0, 300.0, BAND).look(red, 0.03) == 0.0


@pytest.mark.parametrize(
    ("true", "level", "found"),
    [(1.0, 1.0, 1.0), (1.3, 1.0, 1.0), (1.6, 1.0, 1.6**0.5), (0.6, 1.0, 1.0), (0.35, 2.0, 1.4),
     (3.0, 1.0, 2.0), (100.0, 1.0, 2.0), (0.0, 1.0, 0.25)],
)  # fmt: skip
def test_the_level_of_the_noise_follows_the_squares_of_innovations(
    true: float, level: float, found: float
) -> None:
    """`true` is their mean; half of the steps have no fix; a few outliers do not count."""
    squares = np.full(2000, np.nan)
    squares[::2] = true * np.random.default_rng(4).standard_normal(1000) ** 2
    assert find_level(squares[:200], level) == level  # too few
    assert find_level(squares, level) == pytest.approx(found, abs=0.15)
    squares[:20] *= 1e4
    assert find_level(squares, level) == pytest.approx(found, abs=0.15)


@pytest.mark.usefixtures("kernels")
def test_fixes_noisier_or_quieter_than_said_cost_little() -> None:
    """Levels are rounded up: one that is too low makes a right spectrum seem wrong."""
    config = configure("sensors=strong_bias", "record.duration=600", "sensors.imu.rate=20")
    squares: list[float] = []
    for told, least, most in ((1.0, 0.9, 1.1), (1.0 / 3.0, 2.4, 4.1), (3.0, 0.3, 0.71)):
        estimators, square, nees = run(config, 0.1, told=told)
        levels = [filter.told.white for estimator in estimators for filter in estimator._filters]
        assert least < np.median(levels) < most
        squares.append(square)
        assert square < 1.1 * squares[0]  # 27 times if a third of the noise were believed
        assert 0.9 < nees < 1.1


@pytest.mark.usefixtures("kernels")
def test_a_gate_is_patient_with_bursts_while_the_hub_swings_widely() -> None:
    words = ["sensors=strong_bias", "record.duration=600", "sensors.imu.rate=20"]
    bursts = ["sensors.gnss.outliers.rate=0.05", "sensors.gnss.outliers.length=5"]
    _, clean, _ = run(configure(*words), 0.8)
    _, square, nees = run(configure(*words, *bursts), 0.8)
    assert square < 1.5 * clean  # with a gate in haste 3.3 times
    assert nees < 1.3


@pytest.mark.usefixtures("kernels")
def test_an_unknown_tilt_is_found_where_the_motion_shows_it() -> None:
    config = configure(
        "sensors=strong_bias", "record.duration=300", "sensors.imu.rate=20",
        "sensors.imu.tilt=0.03", "skf.tilt=0",
    )  # fmt: skip
    estimators, square, _ = run(config, 2.0)
    leans = [filter._tracker.lean for estimator in estimators for filter in estimator._filters]
    assert np.median(leans) == pytest.approx(GRAVITY * 0.03, abs=0.05)
    _, declared, _ = run(changed(config, skf=changed(config.skf, track_tilt=False)), 2.0)
    assert square < 0.7 * declared


@pytest.mark.usefixtures("kernels")
def test_outliers_and_bursts_are_refused_but_a_hub_that_has_moved_is_followed() -> None:
    config = configure("sensors.imu.rate=20")
    sensors = sensing.sensors(config.sensors)
    rng = np.random.default_rng(7)
    skf = changed(config.skf, red_sigma=0.0)  # else the shift is red noise
    tracking = TrackingFilter(
        skf, sensors, BAND, make_fix_rule(skf, "gate", axes=1), CompiledAxisFilter
    )
    steps, M = 4800, sensors.fix_interval
    calm, fixes = 0.15 * rng.standard_normal(steps), np.full(steps, np.nan)
    fixes[::M] = 0.03 * rng.standard_normal(steps // M)
    fixes[60 * M : 65 * M : M] += 0.4  # a burst
    fixes[90 * M :: M] += 0.4  # the fixes are off for good
    first = tracking.take(calm[: 90 * M], fixes[: 90 * M])
    np.testing.assert_array_equal(first.weight[60 * M : 65 * M : M], 0.0)
    assert np.abs(first.state[60 * M : 70 * M, 0]).max() < 0.05
    assert tracking.model is not None
    later = tracking.take(calm[90 * M :], fixes[90 * M :])
    refused = later.weight[::M] == 0.0
    assert refused[:5].all()
    assert not refused[15:].any()
    assert tracking.model is None
    assert later.state[-1, 0] == pytest.approx(0.4, abs=0.1)


@pytest.mark.parametrize(
    ("good", "bad", "beaten"), [(0, 20, False), (0, 60, True), (500, 60, True)]
)
def test_a_model_is_beaten_when_fixes_were_clearly_less_likely_for_some_time(
    good: int, bad: int, beaten: bool
) -> None:
    """Good predictions of before do not outweigh bad ones of now; steps without a fix count not."""
    past = np.full((6, 2 * (good + bad)), np.nan)
    past[LIKELY, ::2] = np.repeat([2.0, 1.0], [good, bad])
    past[LIKELY_WIDE, ::2] = np.repeat([1.5, 1.3], [good, bad])
    assert _is_beaten(past) == beaten
    assert not _is_beaten(past[:, :0])


@pytest.mark.usefixtures("kernels")
def test_a_drifting_period_costs_no_more_than_assuming_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    config = configure(
        "record.duration=600", "sensors.imu.rate=20", "sensors.imu.sigma=0.05",
        "motion.pace=[[150,1],[450,1.11]]",
    )  # fmt: skip
    _, square, nees = run(config, 2.0)
    monkeypatch.setattr(SpectrumTracker, "look", lambda *_: None)
    _, of_nothing, _ = run(config, 2.0)
    assert square < 1.02 * of_nothing
    assert nees < 1.1


def run(config: Any, amplitude: float, count: int = 3, told: float = 1.0) -> tuple[Any, Any, float]:
    """Return the estimators, mean square position errors after 120 s, and the mean of NEES / 4.

    told: the noise of fixes that SKFA is told, over the true one.
    """
    records = make_records_at(config, {"natural_period": 4.0}, list(range(count)))
    sensors, first = records.sensors, round(120.0 / records.sensors.step)
    known = Known(replace(sensors, position_sigma=told * sensors.position_sigma), config)
    estimators, squares, nees = [], [], []
    for motion, noise in zip(records.motion, records.noise, strict=True):
        seen = observe(motion, records.direction, sensors)
        estimator = SKFA.stream(known)
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
        assert filter.model[0].values[0] == pytest.approx(4.0, rel=0.1)


@pytest.mark.usefixtures("kernels")
def test_the_guard_gives_up_a_model_that_fixes_contradict() -> None:
    config = configure("sensors.imu.rate=20")
    sensors = sensing.sensors(config.sensors)
    rng = np.random.default_rng(2)
    tracking = TrackingFilter(config.skf, sensors, BAND, ALIKE, CompiledAxisFilter)
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
    tracking = TrackingFilter(config.skf, sensors, BAND, ALIKE, CompiledAxisFilter)
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
    tracker.look(tracker.average(force))
    above = tracker.above
    # averaging over .1 s takes 10 % of the variance at 1.7 Hz
    assert above.position == pytest.approx(np.var(swing), rel=0.12)
    assert above.velocity == pytest.approx(np.var(swing) * (2.0 * np.pi * 1.7) ** 2, rel=0.12)
    below = 0.05 * np.sin(2.0 * np.pi * 0.3 * time) * -((2.0 * np.pi * 0.3) ** 2)
    tracker.look(tracker.average(below))
    assert tracker.above.velocity < 1e-9


def test_records_without_time_for_a_look_are_warned_of(caplog: pytest.LogCaptureFixture) -> None:
    configure("schemes=[SKFA]", "record.duration=29", "measures.settling_time=5")
    assert "schemes: SKFA chooses a spectrum after 30 s; records of 29 s" in caplog.text
