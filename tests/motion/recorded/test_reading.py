"""Columns, units and checks: what is guessed, what is refused and with which words."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from owtsweep.errors import InputError
from owtsweep.motion.recorded import checks, describe, read
from owtsweep.motion.recorded.columns import guess_roles
from owtsweep.motion.recorded.units import STANDARD_GRAVITY, find_factor

TIME = np.arange(1000) / 50.0
X = 0.3 * np.sin(TIME)


def record(folder: Path, **columns: np.ndarray) -> Path:
    """An archive of these arrays; `time` is TIME unless given."""
    np.savez(folder / "record.npz", **{"time": TIME, **columns})
    return folder / "record.npz"


def refusal(path: Path, **options) -> str:
    with pytest.raises(InputError) as caught:
        read(path, **options)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (["time", "x", "y"], {"time": "time", "position_x": "x", "position_y": "y"}),
        (["t", "acc_x", "acc_y", "gnss_x"], {"specific_force_x": "acc_x", "fix_x": "gnss_x"}),
        (
            ["time", "specific_force_x", "position_x"],
            {"specific_force_x": "specific_force_x", "reference_x": "position_x"},
        ),
        (
            ["time", "acc_x", "pos_x", "ref_x"],
            {"position_x": "pos_x", "reference_x": "ref_x", "specific_force_x": "acc_x"},
        ),
        (
            ["Time", "RotSpeed", "State pos x  coo: global", "State pos y  coo: global"],
            {"position_y": "State pos y  coo: global"},
        ),
        (["Pitch", "Power"], {}),
    ],
)
def test_guess(names: list[str], expected: dict[str, str]) -> None:
    roles = guess_roles(names)
    assert expected.items() <= roles.items()
    assert ("position_x" in roles) == ("position_x" in expected or "position_y" in expected)


def test_given_columns_win_and_none_leaves_a_role_out(tmp_path: Path) -> None:
    path = record(tmp_path, x=X, y=2 * X, own=3 * X)
    recording = read(path, columns={"position_x": "own", "position_y": None})
    np.testing.assert_array_equal(recording.channels["position_x"], 3 * X)
    assert set(recording.channels) == {"position_x"}


def test_the_other_axis_follows_the_one_that_is_given(tmp_path: Path) -> None:
    """Never a channel of another pair."""
    path = record(tmp_path, x=X, y=2 * X, TwHt2TPxi=3 * X, TwHt2TPyi=4 * X, own=5 * X, acc_x=X)
    assert read(path, columns={"position_x": "TwHt2TPxi"}).names["position_y"] == "TwHt2TPyi"
    assert "position_y" not in read(path, columns={"position_x": "own"}).names
    names = read(path, columns={"reference_y": "y"}).names
    assert (names["reference_x"], names["reference_y"]) == ("x", "y")
    assert "reference_y" not in read(path, columns={"reference_x": "own"}).names


def test_unknown_channels_list_what_is_there_but_not_everything(tmp_path: Path) -> None:
    path = record(tmp_path, **{f"channel_{k}": X for k in range(40)}, TwHt1TPxi=X)
    said = refusal(path, columns={"position_x": "TwHt1TPxj"})
    assert "columns.position_x" in said
    assert "TwHt1TPxi" in said
    assert "more" in said
    assert said.count("channel_") <= 12
    assert "no such role" in refusal(path, columns={"position_z": "x"})


def test_no_time_and_no_channel(tmp_path: Path) -> None:
    np.savez(tmp_path / "r.npz", x=X, y=X)
    assert "no time column" in refusal(tmp_path / "r.npz")
    assert "columns.position_x" in refusal(record(tmp_path, nothing=X))


@pytest.mark.parametrize(
    ("unit", "dimension", "expected"),
    [
        ("mm", "length", 1e-3),
        ("g", "acceleration", STANDARD_GRAVITY),
        ("m/s2", "acceleration", 1.0),
        ("m/s**2", "acceleration", 1.0),
        ("m s^-2", "acceleration", 1.0),
        ("M/SEC^2", "acceleration", 1.0),
        ("m/s²", "acceleration", 1.0),
        ("deg", "angle", np.pi / 180),
        ("ms", "time", 1e-3),
    ],
)
def test_units(unit: str, dimension: str, expected: float) -> None:
    assert find_factor(unit, dimension, "units.x") == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("unit", "said"),
    [
        ("deg", "a unit of angle, not of length"),
        ("kN", "a unit of force, not of length"),
        ("kg", "not a unit known"),
    ],
)
def test_wrong_units_are_refused(tmp_path: Path, unit: str, said: str) -> None:
    message = refusal(record(tmp_path, x=X), units={"position_x": unit})
    assert said in message
    assert "units.position_x" in message
    csv = tmp_path / "r.csv"
    csv.write_text(
        f"time,x ({unit})\n" + "\n".join(f"{t},{x}" for t, x in zip(TIME, X, strict=True))
    )
    assert said in refusal(csv)
    assert read(csv, units={"position_x": "m"}).channels["position_x"][1] == pytest.approx(X[1])


def test_units_are_applied_and_an_assumption_is_noted(tmp_path: Path) -> None:
    path = record(tmp_path, acc_x=X / STANDARD_GRAVITY, time=1000 * TIME)
    recording = read(path, units={"specific_force_x": "g", "time": "ms"})
    np.testing.assert_allclose(recording.channels["specific_force_x"], X)
    np.testing.assert_allclose(recording.time, TIME)
    assert not recording.notes
    assert any("taken as SI" in note for note in read(record(tmp_path, x=X)).notes)


def spoiled(place: int, value: float) -> np.ndarray:
    time = TIME.copy()
    time[place] = value
    return time


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ({"x": X, "time": spoiled(500, 9.0)}, "goes backwards in data row 501"),
        ({"x": X, "time": spoiled(500, TIME[499])}, "stands still in data row 501"),
        ({"x": X, "time": spoiled(7, np.nan)}, "missing in data row 8"),
        ({"x": X[:20], "time": TIME[:20]}, "20 rows"),
        ({"x": np.full(1000, np.nan)}, "no value at all"),
        ({"acc_x": X, "time": 20 * TIME}, "comes at 2.5 Hz; an IMU needs 5 Hz"),
        ({"acc_x": X + 9.81}, "as if it measured gravity"),
        ({"acc_x": X + 9.81 * 9.81}, "as if it measured gravity"),
        ({"x": X + 5000.0 * (TIME > 10)}, "jumps by 5000 m at 10.02 s"),
        ({"x": np.where((TIME > 4) & (TIME < 5), np.nan, X)}, "gaps longer than 0.1 s: 4 s to 5 s"),
        ({"acc_x": np.where((TIME > 4) & (TIME < 5), np.nan, X)}, "gaps=interpolate"),
    ],
)
def test_what_is_wrong_is_said_with_its_place(
    tmp_path: Path, columns: dict[str, np.ndarray], said: str
) -> None:
    assert said in refusal(record(tmp_path, **columns))


def test_a_hole_in_time_is_a_gap(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept = (TIME < 6.0) | (TIME > 8.0)
    path = record(tmp_path, time=TIME[kept], acc_x=X[kept])
    assert "5.98 s to 8.02 s" in refusal(path)
    notes = read(path, gaps="interpolate").notes
    assert any("gaps interpolated: 5.98 s to 8.02 s" in note for note in notes)
    assert "none of refuse, interpolate" in refusal_of_option(path)
    monkeypatch.setattr(checks, "LONGEST_GAP", 3.0)
    assert read(path)


def refusal_of_option(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        read(path, gaps="fill")
    return str(caught.value)


def test_fixes_and_references_may_be_missing(tmp_path: Path) -> None:
    fixes = np.where(np.arange(1000) % 50 == 0, X, np.nan)
    fixes[300:700] = np.nan
    hidden = np.where((TIME > 4) & (TIME < 9), np.nan, X)
    recording = read(record(tmp_path, acc_x=X, fix_x=fixes, ref_x=hidden))
    assert recording.rate("fix_x") == pytest.approx(1.0)
    assert recording.rate("specific_force_x") == pytest.approx(50.0)
    assert any("fix: 1 gap(s)" in note and "5 s to 14 s" in note for note in recording.notes)
    assert any("reference: 1 gap(s)" in note for note in recording.notes)


def test_jitter_is_measured_and_rounding_is_not_jitter(tmp_path: Path) -> None:
    wobble = TIME + 0.002 * np.sin(37.0 * np.arange(1000))
    notes = read(record(tmp_path, x=X, time=wobble)).notes
    assert any("irregular times" in note for note in notes)
    rounded = np.round(np.arange(1000) / 80.0, 3)  # 12.5 ms in whole milliseconds
    assert not any("irregular" in note for note in read(record(tmp_path, x=X, time=rounded)).notes)


def test_describe_is_read_aloud(tmp_path: Path) -> None:
    hidden = np.where((TIME > 4) & (TIME < 9), np.nan, X)
    path = record(tmp_path, acc_x=X, ref_x=hidden, pressure=X, nothing=np.full(1000, np.nan))
    text = describe(path)
    for guess in ("time", "specific_force_x  = acc_x", "reference_x       = ref_x"):
        assert f"  {guess}" in text
    for words in ("NumPy archive, 5 channels, 1000 rows", "50 Hz", "249 missing", "4 s to 9 s"):
        assert words in text
    assert "pressure" in text
    assert max(map(len, text.splitlines()[1:])) < 140


def test_describe_tells_text_from_numbers_and_bad_time(tmp_path: Path) -> None:
    csv = tmp_path / "r.csv"
    csv.write_text("time,x,state\n" + "\n".join(f"{k % 9},{k},ok" for k in range(60)))
    text = describe(csv)
    assert text.endswith("The rest:\n  state")
    assert "goes backwards in data row 10" in text
    assert "no time column" in describe(_npz_without_time(tmp_path))


def _npz_without_time(folder: Path) -> Path:
    np.savez(folder / "r.npz", x=X)
    return folder / "r.npz"


def test_long_files_are_read_by_column(tmp_path: Path) -> None:
    """1e5 rows, 20 columns: what is not asked for is not held (1e7 rows are run by hand)."""
    import tracemalloc

    rng = np.random.default_rng(3)
    rows = 100_000
    lines = [",".join(f"{v:.3f}" for v in row) for row in rng.standard_normal((100, 20))]
    with (tmp_path / "long.csv").open("w") as file:
        file.write("time," + ",".join(f"x{k}" if k else "x" for k in range(20)) + "\n")
        file.writelines(f"{k / 100:.2f},{lines[k % 100]}\n" for k in range(rows))
    tracemalloc.start()
    recording = read(tmp_path / "long.csv")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(recording.time) == rows
    assert peak < 20 * 8 * rows * 1.5  # time and x cost 2 x 8 bytes a row, and copies of them
