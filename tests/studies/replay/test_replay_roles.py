"""A file of accelerations and fixes says which roles these can have; its command then runs."""

from __future__ import annotations

import shlex
from pathlib import Path

import numpy as np
import pytest
from replay_tools import config_of, write_csv

from owtsweep.errors import InputError
from owtsweep.studies.replay.loading import load_record


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
    ("every", "axes", "words", "command"),
    [
        (100, "xy", [], "columns.specific_force_x=ax columns.specific_force_y=ay "
         "columns.fix_x=gps_x columns.fix_y=gps_y"),
        (20, "x", ["units.acceleration_x=mm/s^2"],
         "columns.specific_force_x=ax columns.fix_x=gps_x "
         "units.specific_force_x=mm/s^2 sensors.gnss.rate=5"),
    ],
)  # fmt: skip
def test_the_command_that_is_printed_runs(
    every: int, axes: str, words: list[str], command: str, tmp_path: Path
) -> None:
    file = write_mine(tmp_path / "mine log.csv", every=every, axes=axes)
    told = refuse(file, *(word.replace("=", "='", 1) + "'" for word in words))
    assert "ax" in told.partition("can be specific_force, if a level IMU measured them")[0]
    assert "taken as fix, can be position, if they are the motion itself" in told
    typed = shlex.split(told.partition("For an IMU and a GNSS: ")[2])
    assert typed == ["owtsweep", "replay", str(file), *command.split(" ")]
    overrides = [word.replace("=", "='", 1) + "'" if "^" in word else word for word in typed[3:]]
    record = load_record(config_of([file], *overrides), str(file))
    assert record.gnss == "recorded"
    assert np.isfinite(record.fixes).all()


def test_without_fixes_or_accelerations_it_promises_less(tmp_path: Path) -> None:
    time = np.arange(600) / 10.0
    force = write_csv(tmp_path / "a.csv", {"time": time, "ax": np.sin(time)})
    assert refuse(force).endswith("and beside fixes (columns.fix_x) or a reference "
                                  "(columns.reference_x)")  # fmt: skip
    fixes = write_csv(tmp_path / "f.csv", {"time": time, "gps_x": np.sin(time)})
    typed = shlex.split(refuse(fixes).partition("For motion: ")[2])
    assert load_record(config_of([fixes], *typed[3:]), str(fixes)).gnss == "simulated"
    speed = write_csv(tmp_path / "v.csv", {"time": time, "vx": np.sin(time)})
    assert refuse(speed).endswith("no position: set columns.position_x and columns.position_y")
