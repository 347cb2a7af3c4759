"""A file with a platform's angles: how large gravity in a leaning IMU is."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from replay_tools import config_of, write_csv

from owtsweep.cli import main
from owtsweep.gravity import GRAVITY
from owtsweep.studies.replay.loading import load_record
from owtsweep.sweep.runs import Run

TIME = np.arange(1200) / 20.0
OMEGA = 2.0 * np.pi / 10.0
PITCH = np.deg2rad(3.0 + 2.0 * np.sin(OMEGA * TIME))


def write(path: Path, **angles: np.ndarray) -> Path:
    """A motion of 0.5 m at 10 s along x, and of 0.1 m along y, with channels of angles."""
    x = 0.5 * np.sin(OMEGA * TIME)
    return write_csv(path, {"time": TIME, "position_x": x, "position_y": 0.2 * x, **angles})


def tell(file: Path, *words: str) -> str:
    return load_record(config_of([file], *words), str(file)).lean


def test_gravity_is_compared_with_the_acceleration(tmp_path: Path) -> None:
    roll = 0.5 * (PITCH - PITCH.mean())
    file = write(tmp_path / "f.csv", PtfmPitch=np.rad2deg(PITCH), PtfmRoll=np.rad2deg(roll))
    felt = re.findall(
        r"g sin\((\w+)\) along (\w) varies by (\S+) m/s² \(standard deviation; mean (\S+)\), (\S+) "
        r"times the motion's acceleration of (\S+) m/s²",
        tell(file),
    )
    settled = TIME >= 20.0
    for (name, axis, *numbers), angle, amplitude in zip(
        felt, (PITCH, roll), (0.5, 0.1), strict=True
    ):
        assert (name, axis) in {("PtfmPitch", "x"), ("PtfmRoll", "y")}
        gravity = GRAVITY * np.sin(angle[settled])
        moved = amplitude * OMEGA**2 / np.sqrt(2.0)
        spread, mean, ratio, acceleration = map(float, numbers)
        assert spread == pytest.approx(gravity.std(), rel=0.05)
        assert mean == pytest.approx(gravity.mean(), rel=0.05, abs=1e-3)
        assert acceleration == pytest.approx(moved, rel=0.05)
        assert ratio == pytest.approx(gravity.std() / moved, rel=0.06)


@pytest.mark.usefixtures("kernels")
def test_terminal_and_report_say_that_the_advice_holds_for_a_levelled_imu(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(Run, "draw", lambda self, **how: [])  # pictures take most of the time
    write(tmp_path / "f.csv", PtfmPitch=np.rad2deg(PITCH))
    write(tmp_path / "g.csv")
    quick = ["schemes=[MKF]", "replay.replicates=1"]
    says = "so the advice holds for a levelled IMU only"
    assert main(["replay", "f.csv", *quick, "name=one"]) == 0
    out, _ = capsys.readouterr()
    assert says in " ".join(out.split())
    assert out.splitlines()[-1] == "This holds for a levelled IMU only."
    advice = (tmp_path / "results" / "one" / "report.md").read_text().partition("## The record")[0]
    assert says in advice
    assert main(["replay", "g.csv", *quick, "name=level"]) == 0
    assert "levelled" not in capsys.readouterr().out
    assert "levelled" not in (tmp_path / "results" / "level" / "report.md").read_text()
    assert main(["replay", "f.csv", "g.csv", *quick, "name=both"]) == 0
    assert f"{says}\n" in capsys.readouterr().err
    assert re.search(rf"- f: .*{says}", (tmp_path / "results" / "both" / "report.md").read_text())


@pytest.mark.parametrize(
    ("angles", "axes"),
    [
        ({"PtfmPitch": 57.3 * PITCH}, "x"),
        ({"proj_ang tx coo: global (deg)": 57.3 * PITCH}, "y"),
        ({"State_rot proj_ang ty coo: global (deg)": 57.3 * PITCH}, "x"),
        ({"roll (rad)": PITCH, "pitch (rad)": PITCH}, "xy"),
        ({"pitch (deg)": 57.3 * PITCH}, ""),  # it may be that of the blades
        ({"PtfmPitch": 0.0 * TIME, "PtfmYaw": PITCH}, ""),
        ({"PtfmPitch": np.full(1200, 5.0)}, ""),  # a constant lean is a constant bias
        ({"PtfmPitch": np.where(TIME > 1.0, np.nan, np.inf)}, ""),
    ],
)
def test_which_channels_are_a_platforms_angles(
    angles: dict[str, np.ndarray], axes: str, tmp_path: Path
) -> None:
    told = tell(write(tmp_path / "f.csv", **angles))
    assert "".join(axis for axis in "xy" if f"along {axis}" in told) == axes


def test_what_cannot_be_known_is_said_and_what_is_told_counts(tmp_path: Path) -> None:
    file = write(tmp_path / "f.csv", roll=PITCH, pitch=PITCH)
    assert "g sin(pitch) along x is not known, as pitch has no unit of angle" in tell(file)
    assert tell(file, "columns.platform_pitch=", "columns.platform_roll=") == ""
    text = file.read_text().splitlines()
    text[0] = text[0].replace("pitch", "PtfmPitch")
    words = [line.rpartition(",")[0] + ",calm" for line in text[1:]]  # no numbers, as before
    file.write_text("\n".join([text[0], *words]) + "\n")
    assert tell(file) == ""


def test_a_recorded_imu_has_felt_the_lean_already(tmp_path: Path) -> None:
    force = np.sin(OMEGA * TIME)
    columns = {"time": TIME, "imu_ax": force, "imu_ay": force, "x": force, "PtfmPitch": PITCH}
    assert tell(write_csv(tmp_path / "s.csv", columns)) == ""
