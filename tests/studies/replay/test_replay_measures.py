"""Measures against brute force and against what theory expects of them."""

from __future__ import annotations

import numpy as np
import pytest
from replay_tools import config_of, estimate, measure, motion_file, sensor_file

from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.replay import blocks, facts, measures, place
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.record import listen


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    path = sensor_file(tmp_path_factory.mktemp("m") / "a.csv", duration=600.0, missing=(30,))
    config = config_of([path])
    sensors = sensing.sensors(config.sensors)
    record = load_record(config, str(path))
    measured = listen(config, sensors, record, 0)
    estimated = estimate(config, resolve("HME1"), sensors, measured)
    rows = measure(record, measured.fixes, estimated, sensors, 2000)
    return record, measured, estimated, {(n, w): (v, c) for n, w, v, c in rows}


def test_errors_coverage_and_nees(case):
    record, _, estimated, found = case
    settled = slice(2000, None)
    truth = np.hstack([record.position, record.velocity])
    error = (estimated.state - truth)[settled]
    assert found["x", "settled"][0] == pytest.approx(np.mean(error[:, 0] ** 2))
    assert found["position", "settled"][0] == pytest.approx(
        np.mean(np.sum(error[:, :2] ** 2, axis=1))
    )
    assert found["velocity", "full"][0] == pytest.approx(
        np.mean(np.sum((estimated.state - truth)[:, 2:] ** 2, axis=1))
    )
    inside = np.abs(error) <= 1.959963984540054 * estimated.deviation[settled]
    assert found["coverage_position", "settled"][0] == pytest.approx(np.mean(inside[:, :2]))
    nees = []
    for k in range(0, len(error), 997):
        total = 0.0
        for axis in range(2):
            e = error[k, [axis, axis + 2]]
            total += e @ np.linalg.solve(estimated.axis_covariance(axis)[2000 + k], e)
        nees.append(total)
    every = found["nees", "settled"][0]
    assert np.mean(nees) == pytest.approx(every, rel=0.35)
    parts = [v for (n, w), (v, _) in found.items() if n == "position" and w.startswith("part_")]
    assert len(parts) == measures.PARTS
    assert np.mean(parts) == pytest.approx(found["position", "settled"][0], rel=1e-3)


def test_a_later_fix_tells_the_error_and_its_own_noise(case):
    record, measured, estimated, found = case
    at = 100 * np.arange(len(measured.fixes)) - 20
    at = at[(at >= 2000) & (at < record.steps)]
    error = np.sum((estimated.state[at, :2] - record.position[at]) ** 2, axis=1)
    own = 2.0 * 0.03**2
    residual, count = found["fix_residual", "settled"]
    there = np.isfinite(measured.fixes[(at + 20) // 100, 0])
    assert count == there.sum()
    spread = 3.0 * 2.0 * np.sqrt(np.mean(error) * own) / np.sqrt(count)
    assert residual == pytest.approx(np.mean(error[there]) + own, abs=spread + 3 * own / count**0.5)
    fixes = measured.fixes[(at + 20) // 100]
    brute = np.nanmean(np.sum((fixes - estimated.state[at, :2]) ** 2, axis=1))
    assert residual == pytest.approx(brute)


def test_holding_the_last_fix(case):
    record, measured, _, _ = case
    last, kept = np.zeros(2), []
    for fix in measured.fixes:
        last = fix if np.isfinite(fix[0]) else last
        kept.append(last)
    every = np.repeat(kept, 100, axis=0)[: record.steps]
    squared = np.sum((every - record.position) ** 2, axis=1)
    rows = blocks.run_baselines(config_of([]), record)
    held = {(row.measure, row.window): row.value for row in rows if row.scheme == "last_fix"}
    assert held["position", "settled"] == pytest.approx(np.mean(squared[2000:]))
    assert held["position", "full"] == pytest.approx(np.mean(squared))


def test_whiteness():
    draw = np.random.default_rng(1)
    p = [measures.check_whiteness(draw.standard_normal((300, 2)))[1] for _ in range(400)]
    assert np.mean(np.array(p) < 0.05) == pytest.approx(0.05, abs=0.04)
    assert np.mean(p) == pytest.approx(0.5, abs=0.06)
    white = draw.standard_normal((2000, 2))
    coloured = white[1:] + 0.5 * white[:-1]
    lag_1, p_coloured = measures.check_whiteness(coloured)
    assert lag_1 == pytest.approx(0.4, abs=0.05)  # .5 / 1.25
    assert p_coloured < 1e-10


def test_without_a_reference_there_are_innovations_alone(tmp_path):
    path = sensor_file(tmp_path / "a.csv", reference=False)
    config = config_of([path])
    sensors = sensing.sensors(config.sensors)
    record = load_record(config, str(path))
    measured = listen(config, sensors, record, 0)
    estimated = estimate(config, resolve("HME1"), sensors, measured)
    names = {n for n, *_ in measure(record, measured.fixes, estimated, sensors, 2000)}
    assert names == {"fix_residual", "nis", "innovation", "innovation_lag_1", "innovation_white_p"}
    of_baselines = blocks.run_baselines(config, record)
    assert {row.measure for row in of_baselines} == {"fix_residual"}


def test_fixes_without_delay_are_foreseen_by_the_step_before(tmp_path):
    """The estimate of a fix's own step has used it; that of the step before has not."""
    path = sensor_file(tmp_path / "a.csv", reference=False)
    config = config_of([path], "sensors.gnss.delay=0")
    sensors = sensing.sensors(config.sensors)
    record = load_record(config, str(path))
    measured = listen(config, sensors, record, 0)
    estimated = estimate(config, resolve("MKF"), sensors, measured)
    found = {(n, w): v for n, w, *v in measure(record, measured.fixes, estimated, sensors, 2000)}
    at = np.arange(0, record.steps, sensors.fix_interval)[1:]
    before = estimated.state[at - 1]
    foreseen = before[:, :2] + sensors.step * before[:, 2:]
    apart = np.sum((measured.fixes[1 : len(at) + 1] - foreseen) ** 2, axis=1)[at - 1 >= 2000]
    assert found["fix_residual", "settled"][0] == pytest.approx(np.nanmean(apart))
    # the innovation is the same but for the acceleration of one step
    innovations = found["innovation", "settled"][0]
    assert found["fix_residual", "settled"][0] == pytest.approx(innovations, rel=0.05)
    of_baselines = blocks.run_baselines(config, record)
    assert {row.measure for row in of_baselines} == {"fix_residual"}


def test_records_errors_are_those_expected_of_its_spectrum(tmp_path):
    """End to end: file, grid, sensors, scheme, errors against the expectation without records."""
    from owtsweep.motion.source import translated
    from owtsweep.studies.hub.public import expected_mse

    path = motion_file(tmp_path / "a.csv", duration=1000.0, rms=0.5, period=5.0)
    config = config_of([path])
    sensors = sensing.sensors(config.sensors)
    record = load_record(config, str(path))
    for name in ("MKF", "HME1"):
        scheme = resolve(name)
        mse = []
        for replicate in range(4):
            measured = listen(config, sensors, record, replicate)
            state = estimate(config, scheme, sensors, measured).state[4000:]
            mse.append(np.mean(np.sum((state[:, :2] - record.position[4000:]) ** 2, axis=1)))
        chain = scheme.kernel(Known(sensors, config), record.steps)
        spectrum, floor = place.expect_errors(chain, sensors, (0.05, 0.6))
        rms = float(np.sqrt(np.mean(np.sum(record.position[4000:] ** 2, axis=1))))
        moved, _ = expected_mse(spectrum, translated(5.0).density, (0.05, 0.6), rms=rms)
        expected = moved + floor.of("position")
        assert np.mean(mse) == pytest.approx(expected, rel=0.1), name
        at_record = place.expect_at_record(config, facts_of(config, record))
        assert at_record[name] == pytest.approx(expected, rel=0.1)


def facts_of(config, record):
    """A record's line of records.csv."""
    return {n: v for n, _, v, _ in facts.measure_record(config, record)}
