"""A long record in pieces gives what a short one gives at once, and little memory is enough."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from replay_tools import collect_force, config_of, estimate, motion_file, sensor_file

from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.figures.lines import Envelope, decimate
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.contract import resolve
from owtsweep.studies.hub.estimates import OnePassSeries
from owtsweep.studies.replay import blocks
from owtsweep.studies.replay import record as recorded
from owtsweep.studies.replay.estimating import (
    DEVIATIONS,
    STATES,
    estimate_pieces,
    write_estimates,
)
from owtsweep.studies.replay.figures import traces
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.record import listen, simulate_true_bias

ROOT = Path(__file__).parents[3]
EDGES = [0, 1, 77, 77, 150, 777, 1501]
#: The reference engine solves one problem per step: small ones, few of them.
SLOW = (
    "engine=reference", "sensors.imu.rate=20", "hme.mhe.horizon=5", "hme.mhe.smoother_window=6",
    "hme.mhe.interval=0.5",
)  # fmt: skip


@pytest.fixture
def short_pieces(monkeypatch):
    monkeypatch.setattr(recorded, "PIECE", 640)
    monkeypatch.setattr(recorded.cut_into_pieces, "__defaults__", (640,))


def same(one: Trajectory, other: Trajectory) -> bool:
    assert all(series is not None for series in (*one, *other))
    return all(np.array_equal(a, b, equal_nan=True) for a, b in zip(one, other, strict=True))


def join(pieces: list[Trajectory]) -> Trajectory:
    """Join successive trajectories; rows of an array that a piece lacks are NaN."""

    def join_one(series: tuple[np.ndarray | None, ...]) -> np.ndarray:
        shape = next(array.shape[1:] for array in series if array is not None)
        rows = [np.full((len(piece.state), *shape), np.nan) for piece in pieces]
        return np.concatenate([
            none if array is None else array for array, none in zip(series, rows, strict=True)
        ])  # fmt: skip

    return Trajectory(*map(join_one, zip(*pieces, strict=True)))


@pytest.mark.parametrize("name", ["EKF", "MKF", "HME1", "HME2"])
@pytest.mark.parametrize("how", ["motion", "every fix", "missing fixes", "reference engine"])
def test_estimates_do_not_depend_on_the_pieces(tmp_path, short_pieces, name, how):
    path, slow = tmp_path / "a.csv", how == "reference engine"
    if how == "motion":
        motion_file(path, duration=30.0)
    else:
        missing = (9, 10) if how == "missing fixes" else ()
        sensor_file(path, duration=9.0 if slow else 30.0, missing=missing)
    own = SLOW if slow else ()
    config = config_of([path], "sensors.yaw=25", "measures.settling_time=5", *own)
    sensors = sensing.sensors(config.sensors)
    record = load_record(config, str(path))
    edges = [*(e for e in EDGES if e < record.steps), record.steps]
    whole = estimate(config, resolve(name), sensors, listen(config, sensors, record, 0))
    signals = [listen(config, sensors, record, 0)]
    pieces = [p for (p,) in estimate_pieces(config, resolve(name), sensors, signals, edges)]
    assert [len(p.state) for p in pieces] == list(np.diff(edges))
    assert same(join(pieces), whole)


@pytest.mark.parametrize("name", ["MKF", "HME2"])
def test_replicates_side_by_side_are_those_alone(tmp_path, name):
    path = motion_file(tmp_path / "a.csv", duration=30.0)
    config = config_of([path])
    sensors = sensing.sensors(config.sensors)
    record = load_record(config, str(path))
    several = [listen(config, sensors, record, replicate) for replicate in range(5)]
    edges = [0, record.steps]
    beside = next(estimate_pieces(config, resolve(name), sensors, several, edges))
    for signals, found in zip(several, beside, strict=True):
        alone = next(estimate_pieces(config, resolve(name), sensors, [signals], edges))[0]
        assert same(found, alone)


def test_rows_do_not_depend_on_what_runs_side_by_side(tmp_path, monkeypatch):
    path = motion_file(tmp_path / "a.csv", duration=40.0)
    config = config_of([path], "replay.replicates=5", "schemes=[EKF,HME1]")

    def tables() -> list:
        return [rows for _, rows in blocks.run(config, blocks.plan(config))]

    together = tables()
    monkeypatch.setattr(blocks, "STEPS_AT_ONCE", 1)
    monkeypatch.setattr(blocks, "LONG", 0)
    for one, other in zip(together, tables(), strict=True):
        assert one.equals(other)
        assert len(one) > 20


def test_the_noise_does_not_depend_on_the_pieces(tmp_path):
    path = motion_file(tmp_path / "a.csv", duration=30.0)
    config = config_of([path], "sensors.yaw=25")
    sensors = sensing.sensors(config.sensors)
    record = load_record(config, str(path))
    signals = listen(config, sensors, record, 3)
    whole = collect_force(signals)
    assert np.array_equal(np.concatenate([*signals.force(700)]), whole)
    # by hand: the streams as DESIGN.md has them
    named = partial(recorded.stream, config.seed, "replay", (0.0,), 3)
    noise = sensing.Measured(
        sensing.ForceNoise(config.sensors, sensors, named).next(record.steps),
        sensing.fix_noise(config.sensors, sensors, record.steps, named),
    )
    force = record.acceleration @ sensors.rotation + noise.specific_force
    assert np.array_equal(whole, force)
    assert np.array_equal(signals.fixes, record.fixes + noise.fixes)


def test_the_simulated_bias_is_that_of_the_noise(tmp_path, monkeypatch):
    path = motion_file(tmp_path / "a.csv", duration=30.0)
    config = config_of([path], "sensors.yaw=25", "sensors.imu.sigma=1e-9")
    sensors = sensing.sensors(config.sensors)
    record = load_record(config, str(path))
    monkeypatch.setattr(recorded, "PIECE", 640)
    found = np.concatenate([*simulate_true_bias(config, sensors, record.steps, 2)])
    force = collect_force(listen(config, sensors, record, 2)) @ sensors.rotation.T
    expected = force - record.acceleration + np.array(sensors.gravity)
    assert np.max(np.abs(found - expected)) < 1e-7
    assert np.ptp(found[:, 0]) > 1e-4


def list_lines(shown: traces.Traces) -> list:
    """The pieces of all lines of estimates, errors, truth and IMU."""
    pairs = [*shown.lines.values(), *filter(None, (shown.truth, shown.imu))]
    lines = [line for pair in pairs for line in pair] + [*shown.errors.values()]
    return [piece for line in lines for piece in line]


@pytest.mark.parametrize("kind", ["motion", "reference", "neither"])
def test_figures_show_the_same_whatever_the_pieces(tmp_path, monkeypatch, kind):
    path = tmp_path / "a.csv"
    if kind == "motion":
        motion_file(path, duration=60.0)
    else:
        sensor_file(path, duration=60.0, reference=kind == "reference")
    config = config_of([path])
    write_estimates(config, str(path), tmp_path, print)
    one = traces.Session(config, str(path), None, {}, tmp_path / "estimates.parquet")
    stored = pd.read_parquet(tmp_path / "estimates.parquet")
    whole = {}
    for name in config.schemes:
        for steps in one.windows.values():
            state, deviation = np.split(one.read(name, steps), 2, axis=1)
            rows = stored[stored["scheme"] == name].iloc[steps]
            assert np.allclose(state + np.append(one.record.origin, [0, 0]), rows[[*STATES]], 1e-12)
            assert np.array_equal(deviation, rows[[*DEVIATIONS]])
        whole[name] = one.read(name, one.windows["whole"], STATES)
    # with this tuning MKF is the same estimator as EKF
    assert traces.find_distinct(whole) == [name for name in config.schemes if name != "EKF"]
    drawn = [traces.collect_traces(one, name, zoom=False) for name in ("bias", "acceleration")]
    monkeypatch.setattr(recorded, "PIECE", 640)
    monkeypatch.setattr(recorded.cut_into_pieces, "__defaults__", (640,))
    write_estimates(config, str(path), tmp_path, print)
    other = traces.Session(config, str(path), None, {}, tmp_path / "estimates.parquet")
    assert one.windows == other.windows
    assert set(one.chains) == set(config.schemes) - {"SKFA"}
    again = [traces.collect_traces(other, name, zoom=False) for name in ("bias", "acceleration")]
    for before, after in zip(drawn, again, strict=True):
        assert set(before.lines) == set(config.schemes) - {"EKF", "SKFA"}
        assert set(before.errors) == (set(before.lines) if kind == "motion" else set())
        assert (before.truth is None) == (kind != "motion")
        assert before.view == after.view
        for one_line, other_line in zip(list_lines(before), list_lines(after), strict=True):
            assert np.array_equal(one_line, other_line)
    shown = traces.collect_traces(one, "position", zoom=False)
    scaled = [values for _, values in shown.residuals.values()]
    assert len(scaled) == (4 if kind == "neither" else 0)
    assert all(0.3 < np.std(values) < 3.0 for values in scaled)


def test_a_scheme_that_failed_has_no_estimates(tmp_path):
    path = motion_file(tmp_path / "a.csv", duration=30.0)
    config = config_of([path], "schemes=[EKF,MKF]")
    write_estimates(config, str(path), tmp_path, print, failed=["EKF"])
    assert {*pd.read_parquet(tmp_path / "estimates.parquet")["scheme"]} == {"MKF"}
    assert [one.name for one in (tmp_path / "estimates").iterdir()] == ["MKF.csv"]


def test_the_windows_are_about_the_largest_motion(tmp_path):
    path = motion_file(tmp_path / "a.csv", duration=60.0)
    record = load_record(config_of([path]), str(path))
    found = traces.choose_windows(record, record.position)
    time, size = record.time_at(slice(None)), np.hypot(*record.position.T)
    inside = (time >= time[0] + 27.5) & (time <= time[-1] - 7.5)
    middle = time[np.argmax(np.where(inside, size, -1.0))]
    shown = time[found["zoom"]]
    assert shown[0] == pytest.approx(middle - 7.5, abs=0.011)
    assert shown[-1] == pytest.approx(middle + 7.5, abs=0.011)
    assert found["whole"] == slice(0, record.steps)


@pytest.mark.parametrize("count", [900, 1200, 1201, 5003])
@pytest.mark.parametrize("piece", [1, 7, 640, 10_000])
def test_an_envelope_is_the_decimated_series(count, piece):
    values = np.round(np.random.default_rng(count).standard_normal(count), 1)  # with equal ones
    envelope = Envelope(count)
    padded = np.concatenate([values, np.full(30, np.nan)])
    for at in range(0, len(padded), piece):
        envelope.add(padded[at : at + piece])
    steps, found = envelope.points()
    at, expected = decimate(np.arange(count), values, 1200)
    assert np.array_equal(steps, at)
    assert np.array_equal(found, expected)


def test_rows_hold_a_piece_only():
    series = np.arange(40.0).reshape(20, 2)
    rows = OnePassSeries((series[at : at + 3] for at in range(0, 20, 3)), (20, 2))
    for begin, stop in [(0, 2), (1, 8), (6, 8), (7, 20)]:
        assert np.array_equal(rows[begin:stop], series[begin:stop])
    assert len(rows) == 20
    with pytest.raises(IndexError, match="row 2 has been forgotten"):
        rows[2:8]


REPLAY = """
import json, os, resource, sys
from owtsweep.cli import main
code = main(["replay", *sys.argv[1:]])
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1e3)
if os.path.exists("/proc/self/status"):  # there getrusage's peak is at least that of pytest
    status = dict(line.split(":", 1) for line in open("/proc/self/status"))
    peak = 1024 * float(status["VmHWM"].split()[0])
print(json.dumps({"code": code, "peak": peak}))
"""
#: Bytes that a replay takes of a record of a minute (libraries, compiled code, figures): 506 MB
#: were seen.
BARE = 540e6
#: What pieces take whatever the record's length, and the gains of three schemes, which are stored
#: for 2**18 steps at most (`hub.chain.LONGEST_TRANSIENT`).
PIECES, GAINS = 220e6, 130e6


def replay_long(folder: Path, rows: int, *overrides: str) -> tuple[float, Path]:
    """Peak memory (bytes) and run folder of a motion of so many rows at 100 Hz."""
    import pyarrow as pa
    import pyarrow.csv as pc

    time = 0.01 * np.arange(rows)
    columns = {"time": np.round(time, 2)}
    for name, period in (("position_x", 4.0), ("position_y", 5.1)):
        wave = np.sin(2.0 * np.pi * time / period) + 0.3 * np.sin(2.0 * np.pi * time / 7.3)
        columns[name] = np.round(wave, 6)
    pc.write_csv(pa.table(columns), folder / "long.csv")
    done = subprocess.run(
        [sys.executable, "-c", REPLAY, "long.csv", "name=long", *overrides],
        cwd=folder, capture_output=True, text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT / "src")},
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["code"] == 0
    return found["peak"], folder / "results/long"


@pytest.mark.faults
def test_memory_grows_by_the_record_alone(tmp_path, kernels):
    """Position, velocity and acceleration are 48 bytes a row; reading and resampling need more."""
    small = motion_file(tmp_path / "small.csv", duration=30.0)
    config = config_of([small], "replay.replicates=1")
    list(blocks.run(config, blocks.plan(config)))  # compiling takes memory of its own
    write_estimates(config, str(small), tmp_path, print)
    session = traces.Session(config, str(small), None, {}, tmp_path / "estimates.parquet")
    traces.collect_traces(session, "bias", zoom=False)
    rows = 400_000
    peak, run = replay_long(tmp_path, rows, "replay.replicates=1", "schemes=[MKF,HME1,HME2]")
    import pyarrow.parquet as pq

    assert pq.ParquetFile(run / "estimates.parquet").metadata.num_rows == 3 * (rows - 20)
    print(f"{peak / 1e6:.0f} MB")
    assert peak < BARE + PIECES + GAINS + 150 * rows


@pytest.mark.faults
def test_ten_million_rows_in_less_than_two_gigabytes(tmp_path):
    if shutil.disk_usage(tmp_path).free < 4e9:
        pytest.skip("less than 4 GB of free disk: the record and its estimates take 2.5 GB")
    try:
        peak, run = replay_long(tmp_path, 10_000_000, "replay.replicates=1", "schemes=[HME1]")
        assert (run / "estimates/HME1.csv").stat().st_size > 1e9
        assert (run / "figures/bias.png").is_file()
        assert peak < 2e9
    finally:  # pytest keeps the folders of three runs
        shutil.rmtree(tmp_path)
