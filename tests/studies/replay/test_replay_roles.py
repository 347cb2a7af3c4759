"""What a file of accelerations and fixes is taken for, and at which rates it is run."""

from __future__ import annotations

import shlex
from pathlib import Path

import numpy as np
import pytest
from replay_tools import config_of, sensor_file, write_csv

from owtsweep.errors import InputError
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.running import configure


def write_mine(path: Path, *, every: int = 100, axes: str = "xy") -> Path:
    """A file as a logger writes it: ax and gps_x, 60 s at 100 Hz, a fix each `every` rows."""
    rng, time = np.random.default_rng(0), np.arange(6000) / 100.0
    fixes = np.where(np.arange(6000) % every == 0, np.sin(time), np.nan)
    columns = {"time": time}
    columns |= {f"a{axis}": -np.sin(time) + rng.normal(0.0, 0.1, 6000) for axis in axes}
    return write_csv(path, {**columns, **{f"gps_{axis}": fixes for axis in axes}})


def refuse(file: Path, *words: str) -> str:
    with pytest.raises(InputError) as caught:
        load_record(config_of([file], *words), str(file))
    return str(caught.value)


@pytest.mark.parametrize(
    ("every", "axes", "words", "taken"),
    [
        (100, "xy", [], "ax, ay at 100 Hz; fixes: gps_x, gps_y at 1 Hz"),
        (20, "x", ["units.specific_force_x='mm/s^2'"], "ax at 100 Hz; fixes: gps_x at 5 Hz"),
    ],
)
def test_accelerations_beside_fixes_are_those_of_an_imu_and_it_says_so(
    every: int, axes: str, words: list[str], taken: str, tmp_path: Path
) -> None:
    file = write_mine(tmp_path / "mine log.csv", every=every, axes=axes)
    config = configure([str(file)], words)
    assert config.sensors.gnss.rate == 100 / every
    record = load_record(config, str(file))
    assert record.gnss == "recorded"
    assert np.isfinite(record.fixes).all()
    assert f"specific force of a level IMU: {taken} (columns.ROLE=NAME" in record.notes[1]
    motion = refuse(file, *words, "columns.acceleration_x=ax")
    assert "accelerations, but no position: for an IMU name its channels" in motion


def test_rates_are_those_of_the_files_unless_they_are_stated_or_differ(tmp_path: Path) -> None:
    slow, fast = (str(write_mine(tmp_path / f"{n}.csv", every=n)) for n in (20, 50))
    assert configure([fast]).sensors.gnss.rate == 2.0
    assert configure([fast], ["sensors.gnss.rate=4"]).sensors.gnss.rate == 4.0
    assert configure([fast], ["sensors=strong_bias"]).sensors.gnss.rate == 1.0
    assert configure([fast, slow]).sensors.gnss.rate == 1.0


def test_a_rate_is_measured_through_jitter_and_gaps(tmp_path: Path) -> None:
    file = sensor_file(tmp_path / "s.csv", duration=40.0, missing=(12, 13, 20), jitter=0.1)
    assert configure([str(file)]).sensors.gnss.rate == 1.0


def test_without_fixes_or_accelerations_it_promises_less(tmp_path: Path) -> None:
    time = np.arange(600) / 10.0
    force = write_csv(tmp_path / "a.csv", {"time": time, "ax": np.sin(time)})
    assert "and fixes (columns.fix_x) or a reference (columns.reference_x)" in refuse(force)
    fixes = write_csv(tmp_path / "f.csv", {"time": time, "gps_x": np.sin(time)})
    typed = shlex.split(refuse(fixes).partition("the motion itself: ")[2])
    assert load_record(config_of([fixes], *typed[3:]), str(fixes)).gnss == "simulated"
    speed = write_csv(tmp_path / "v.csv", {"time": time, "vx": np.sin(time)})
    assert refuse(speed).endswith("no position: set columns.position_x and columns.position_y")


def test_times_in_milliseconds_are_said_how_to_state(tmp_path: Path) -> None:
    time = 10.0 * np.arange(6000)
    columns = {"time": time, "ax": np.sin(time), "gps_x": np.where(time % 1000, np.nan, 1.0)}
    file = write_csv(tmp_path / "ms.csv", columns)
    assert refuse(file).endswith("if times are in milliseconds, set units.time=ms")
