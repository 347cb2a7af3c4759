"""What a replay recommends: schemes against baselines, the fit's coverage, the record's peaks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from replay_tools import config_of, motion, motion_file, sensor_file, write_csv

import owtsweep
from owtsweep.motion.modes import find_modes
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.contract import Known
from owtsweep.studies.hub.public import resolve_all
from owtsweep.studies.replay import advice, blocks, measures
from owtsweep.studies.replay.describe import tell_row
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.record import listen

QUICK = ["schemes=[MKF,HME1]", "replay.replicates=5", "measures.settling_time=5"]
NAMES = ["MKF", "HME1", "NONE", "HOLD", "DELTA"]
RANKS = {"MKF": 17, "HME1": 19}


def choose(*means: float, spread: float = 0.0, n: int = 20) -> dict:
    noise = spread * np.random.default_rng(0).standard_normal((len(means), n))
    best = NAMES[int(np.argmin(means[:2]))]
    return advice.choose_simplest(np.array(means)[:, None] + noise, NAMES, best, RANKS)


def test_what_a_baseline_beats_is_not_recommended():
    found = choose(2.26, 2.5, 9.0, 1.95, 8.0)
    assert (found["recommended"], found["baseline"]) == ("HOLD", "HOLD")
    assert found["baseline_difference"] == pytest.approx(0.31)
    assert choose(1.0, 2.0, 9.0, 3.0, 8.0)["recommended"] == "MKF"
    assert choose(1.0, 2.0, 9.0, 3.0, 8.0)["baseline"] == "HOLD"


def test_the_simplest_is_named_of_what_cannot_be_told_apart():
    assert choose(1.02, 1.0, 9.0, 9.0, 9.0)["recommended"] == "MKF"  # the margin is small
    assert choose(1.3, 1.0, 9.0, 9.0, 9.0)["recommended"] == "HME1"
    assert choose(1.3, 1.0, 9.0, 9.0, 9.0, spread=2.0)["recommended"] == "MKF"  # scatter
    assert choose(1.03, 1.0, 1.04, 1.01, 9.0)["recommended"] == "NONE"


def test_one_bad_part_does_not_hide_a_large_difference():
    samples = np.ones((5, 20))
    samples[[0, 2, 3]] = 50.0
    samples[4, 7] = 400.0  # a gap of fixes
    found = advice.choose_simplest(samples, NAMES, "HME1", RANKS)
    assert found["recommended"] == "HME1"


def test_baselines_are_those_of_the_hub_also_with_missing_fixes(tmp_path):
    path = sensor_file(tmp_path / "gap.csv", duration=25.0, missing=range(8, 19))
    config = config_of([path], "measures.settling_time=5")
    sensors = sensing.sensors(config.sensors)
    record = load_record(config, str(path))
    signals = listen(config, sensors, record, 0)
    rows = blocks.run_baselines(config, record)
    found = {(row.scheme, row.measure, row.window): row.value for row in rows}
    at = np.arange(1, len(signals.fixes)) * 100 - sensors.delay
    for (row, _), scheme in zip(
        measures.BASELINE_ROWS.items(), resolve_all(["NONE", "HOLD", "DELTA"], config), strict=True
    ):
        estimator, states = scheme.start(Known(sensors, config)), []
        for k in range(record.steps):
            fix = signals.fixes[k // 100] if k % 100 == 0 else np.full(2, np.nan)
            told = estimator.update(np.zeros(2), fix if np.isfinite(fix[0]) else None)
            states.append([*told.position, *told.velocity])
        state = np.array(states)
        p = np.sum((state[:, :2] - record.position) ** 2, axis=1)
        v = np.sum((state[:, 2:] - record.velocity) ** 2, axis=1)
        residual = np.sum((signals.fixes[1:] - state[at, :2]) ** 2, axis=1)
        for window, begin in (("full", 0), ("settled", 500)):
            assert found[row, "position", window] == pytest.approx(p[begin:].mean(), rel=1e-8)
            assert found[row, "velocity", window] == pytest.approx(v[begin:].mean(), rel=1e-8)
            expected = np.nanmean(residual[at >= begin])
            assert found[row, "fix_residual", window] == pytest.approx(expected, rel=1e-8)
        parts = np.linspace(500, record.steps, 21).astype(int)
        assert found[row, "position", "part_07"] == pytest.approx(p[parts[7] : parts[8]].mean())


def test_a_still_record_needs_no_estimator_and_the_report_begins_so(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    replay = owtsweep.replay(str(motion_file(Path("still.csv"), rms=0.003)), QUICK)
    advised = replay.advice()
    row = advised.iloc[0]
    assert (row["best"], row["recommended"], row["baseline"]) == ("MKF", "NONE", "NONE")
    assert row["value_baseline"] < row["value_best"]
    sentence = tell_row(row.to_dict())
    assert "NONE is best: error 0.00" in sentence
    assert "Runner-up: MKF, " in sentence
    assert "NONE: no estimator needed, motion below the sensors." in sentence


def test_the_map_is_no_advice_for_a_peak_outside_the_band(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    time, waves = motion(60.0, rms=0.04, seed=3)
    path = write_csv(
        Path("outside.csv"),
        {"time": time, "position_x": waves + 0.25 * np.sin(5.6 * time), "position_y": 0.0 * time},
    )
    replay = owtsweep.replay(str(path), QUICK)
    record, advised = replay.records().iloc[0], replay.advice().set_index("source")
    assert record["mode_1_period"] == pytest.approx(2.0 * np.pi / 5.6, rel=0.02)
    assert record["mode_1_share"] == pytest.approx(0.95, abs=0.03)
    assert record["fit_share"] < 0.1
    by_map = advised.loc["map"]
    assert not by_map["advises"]
    assert advised.loc["record", "recommended"] == "HME1"
    assert by_map["contradicts_record"]
    sentence = tell_row({**by_map.to_dict(), "source": "map"})
    assert sentence.startswith("The expected map is no advice here: the fit of Eq. (1) covers only")
    assert "This contradicts the record's own errors" in sentence


def test_peaks_beside_each_other_and_none_in_one_peak():
    (_, tower), (_, waves) = (motion(600.0, period=p, rms=0.3, seed=1) for p in (3.1, 8.0))
    one, two = find_modes(tower[:, None], 0.05).found, find_modes((tower + waves)[:, None], 0.05)
    assert [mode.period for mode in one] == pytest.approx([3.1], rel=0.03)
    assert sorted(mode.period for mode in two.found) == pytest.approx([3.1, 8.0], rel=0.1)
    assert sum(mode.share for mode in two.found) == pytest.approx(1.0, abs=0.02)
    assert find_modes(np.zeros((1000, 2)), 0.05).found == ()
