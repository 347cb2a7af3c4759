"""The signals of a study's file: named, in SI units, at uniform times, or refused in one line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from owtsweep.errors import InputError
from owtsweep.motion.recorded import Signals, Wanted, read, read_signals
from owtsweep.studies.blade.recorded_case import UNIT
from owtsweep.studies.floater.motion_recorded import WANTED as OF_FLOATER
from owtsweep.studies.tower.recorded import WANTED as OF_TOWER

TIME = np.arange(600) / 20.0
WANTED = Wanted("recorded.columns", {"x": "length", "fx": "acceleration"}.get, "x, fx", ("x",))


def move(time: np.ndarray) -> np.ndarray:
    return np.sin(0.8 * time) + 0.3 * np.cos(2.1 * time)


def write(path: Path, time: np.ndarray, **columns: np.ndarray) -> Path:
    pd.DataFrame({"time": time, "x": move(time), **columns}).to_csv(path, index=False)
    return path


def read_x(path: Path, *items: str) -> Signals:
    return read_signals(path, WANTED, items)


def refusal(path: Path, *items: str) -> str:
    with pytest.raises(InputError) as caught:
        read_x(path, *items)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_uniform_times_are_left_alone(tmp_path: Path) -> None:
    found = read_x(write(tmp_path / "r.csv", TIME, other=TIME))
    assert np.array_equal(found.time, TIME)
    assert np.array_equal(found.values["x"], move(TIME))
    assert (found.unused, found.notes) == (("other",), ())


@pytest.mark.parametrize("most", [0.1, 0.25, 0.4])
def test_jitter_is_resampled_with_a_note(tmp_path: Path, most: float) -> None:
    late = TIME + 0.05 * most * np.random.default_rng(1).uniform(-1.0, 1.0, len(TIME))
    found = read_x(write(tmp_path / "r.csv", late))
    assert found.step == pytest.approx(0.05, rel=1e-4)
    assert np.ptp(np.diff(found.time)) < 1e-9
    assert found.values["x"][3:-3] == pytest.approx(move(found.time)[3:-3], abs=1e-3)
    assert len(found.notes) == 1
    assert "irregular times, median interval" in found.notes[0]
    found.require_record(20.0, len(TIME))


def test_coarsely_rounded_times_are_uniform(tmp_path: Path) -> None:
    found = read_x(write(tmp_path / "r.csv", np.rint(2.5 * np.arange(100) + 0.25)))
    assert found.step == pytest.approx(2.5, rel=1e-3)
    assert found.notes == ()


def test_a_clock_that_wanders_far_is_never_extrapolated(tmp_path: Path) -> None:
    wander = np.cumsum(np.random.default_rng(2).uniform(0.03, 0.07, 600))
    found = read_x(write(tmp_path / "r.csv", wander))
    assert np.abs(found.values["x"] - move(found.time)).max() < 1e-2


def test_up_to_four_missing_rows_are_filled_and_more_refused(tmp_path: Path) -> None:
    found = read_x(write(tmp_path / "r.csv", np.delete(TIME, [100, 101, 102, 103, 300])))
    assert found.time == pytest.approx(TIME)
    assert found.values["x"] == pytest.approx(move(TIME), abs=5e-3)
    assert found.notes == ("5 rows are missing: filled by cubic spline",)
    told = refusal(write(tmp_path / "r.csv", np.delete(TIME, range(100, 105))))
    assert "time (time) has gaps longer than 0.25 s: 4.95 s to 5.25 s; cut" in told


def test_a_replay_bears_the_same_gaps(tmp_path: Path) -> None:
    found = read(write(tmp_path / "r.csv", np.delete(TIME, range(100, 104))))
    assert any("gaps interpolated: 4.95 s to 5.2 s" in note for note in found.notes)
    with pytest.raises(InputError, match=r"gaps longer than 0.25 s: 4.95 s to 5.25 s; cut the rec"):
        read(write(tmp_path / "r.csv", np.delete(TIME, range(100, 105))))


def _with(row: int, value: float) -> np.ndarray:
    time = TIME.copy()
    time[row] = value
    return time


@pytest.mark.parametrize(
    ("time", "said"),
    [
        (_with(9, TIME[8] + 1e-6), "nearly stands still in data row 10: 1e-06 s after the row bef"),
        (_with(9, TIME[8]), "stands still in data row 10"),
        (_with(9, 0.0), "goes backwards in data row 10"),
        (_with(9, np.nan), "is missing in data row 10"),
        (_with(-1, 1e9), "a regular grid would have 2e+10 steps"),
        (_with(-1, 1.7e308), "does the time jump?"),
        (TIME * 1e300, "lasts"),
        (TIME[:31], "has 31 rows; at least 32 are needed"),
    ],
)
def test_times_that_are_none(tmp_path: Path, time: np.ndarray, said: str) -> None:
    path = tmp_path / "r.csv"
    pd.DataFrame({"time": time, "x": move(TIME[: len(time)])}).to_csv(path, index=False)
    if said == "lasts":
        with pytest.raises(InputError, match=r"record.rate: 20 Hz, but .* has a row every"):
            read_x(path).require_record(20.0, 100)
    else:
        assert said in refusal(path)


def test_names_with_colons_and_units_of_the_user(tmp_path: Path) -> None:
    path = tmp_path / "r.csv"
    pd.DataFrame({"time": TIME, "coo: global": move(TIME), "Fx": TIME}).to_csv(path, index=False)
    found = read_x(path, "x:coo: global:mm", "fx:FX:g")
    assert found.values["x"] == pytest.approx(1e-3 * move(TIME))
    assert found.values["fx"] == pytest.approx(9.80665 * TIME)
    assert np.array_equal(read_x(path, "x:coo: global").values["x"], move(TIME))
    assert "recorded.columns=[x:NAME:UNIT]: 'kg' is not a unit" in refusal(path, "x:coo: global:kg")
    assert "is not SIGNAL:NAME or SIGNAL:NAME:UNIT; signals are time, x, fx" in refusal(path, "x")


def test_times_with_dates_become_seconds(tmp_path: Path) -> None:
    dates = pd.Timestamp("2024-05-01") + pd.to_timedelta(TIME, unit="s")
    path = tmp_path / "r.csv"
    texts = dates.strftime("%Y-%m-%dT%H:%M:%S.%fZ")
    pd.DataFrame({"time": texts, "x": move(TIME)}).to_csv(path, index=False)
    assert read_x(path).time == pytest.approx(TIME)


#: Every column that a study asks for, so that each reads the same file.
ALL = {
    name: move(TIME)
    for name in ["x", "y", "z", "phi", "theta", "psi", "fx", "fy", "fz", "wx", "wy", "wz", "a_012"]
}


def _spoil(column: str, row: int, value: float) -> Callable[[pd.DataFrame], pd.DataFrame]:
    def spoil(table: pd.DataFrame) -> pd.DataFrame:
        table.loc[row, column] = value
        return table

    return spoil


@pytest.mark.parametrize(
    "spoil",
    [
        _spoil("time", 5, np.nan),
        _spoil("time", 5, 0.0),
        _spoil("time", 599, 1e9),
        lambda table: table.drop(index=range(100, 105)),
        lambda table: table[:20],
        lambda table: table[:0],
        lambda table: table.rename(columns={"time": "clock"}),
        lambda table: table.rename(columns={"time": "time (furlong)"}),
    ],
)
def test_the_same_mistake_gives_the_same_line_in_every_study(
    tmp_path: Path, spoil: Callable[[pd.DataFrame], pd.DataFrame]
) -> None:
    path = tmp_path / "r.csv"
    spoil(pd.DataFrame({"time": TIME, **ALL})).to_csv(path, index=False)
    lines = set()
    for wanted in (OF_TOWER, OF_FLOATER, UNIT):
        with pytest.raises(InputError) as caught:
            read_signals(path, replace(wanted, key="recorded.columns"), [])
        lines.add(str(caught.value))
    assert len(lines) == 1
    with pytest.raises(InputError) as caught:
        read(path)
    line, hub = lines.pop(), str(caught.value)
    if "gaps" not in line and "spans" not in line:  # a gap is that of a channel, not of a file
        assert hub[:90] == line[:90]
