"""Recorded motion of six degrees of freedom, from CSV and MATLAB files; what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from linear_records import STEP, move
from scipy.io import savemat

from owtsweep.errors import InputError
from owtsweep.studies import compose
from owtsweep.studies.floater.contest import describe_truth
from owtsweep.studies.floater.contract import DOF
from owtsweep.studies.floater.truth import make_truth

TIME = STEP * np.arange(2000)
POSITION, VELOCITY, ACCELERATION = move(TIME, 5)
COLUMNS = {"time": TIME, **dict(zip(DOF, POSITION.T, strict=True))}
WORDS = ["study=floater", "motion.kind=recorded", "record.duration=90", "record.settling=10"]


def write(folder: Path, columns=COLUMNS, units=()) -> Path:
    """Write columns as the file's ending says; `units` are name -> unit in the line of names."""
    path = folder / "basin.csv"
    units = dict(units)
    names = ",".join(f"{name} [{units[name]}]" if name in units else name for name in columns)
    np.savetxt(path, np.column_stack(list(columns.values())), "%.17g", ",", header=names,
               comments="")  # fmt: skip
    return path


def read(path: Path, *words: str):
    return make_truth(compose([*WORDS, f"motion.file={path}", *words]), 0)


def refusal(path: Path, *words: str) -> str:
    with pytest.raises(InputError) as caught:
        read(path, *words)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_csv_file_gives_its_motion_and_exact_derivatives(tmp_path: Path) -> None:
    motion = read(write(tmp_path), "grid.delay=[4]", "motion.attitude=small")
    truth = motion.truth
    assert np.array_equal(truth.position, POSITION[:1800])
    inner = slice(10, -110)  # a spline knows less at the ends of the file
    assert truth.velocity[inner] == pytest.approx(VELOCITY[:1800][inner], abs=1e-6)
    assert truth.acceleration[inner] == pytest.approx(ACCELERATION[:1800][inner], abs=1e-5)
    assert truth.rate == pytest.approx(truth.velocity[:, 3:])
    assert np.array_equal(motion.at(np.array([-0.15])), POSITION[:1])
    assert not motion.series.velocity[: motion.lead].any()


def test_the_answer_is_for_this_motion_alone(tmp_path: Path) -> None:
    config = compose([*WORDS, f"motion.file={write(tmp_path)}"])
    said = "this motion of basin.csv alone, with noise drawn anew; 90 s at 20 Hz"
    assert describe_truth(config) == said


def test_matlab_files_of_versions_4_and_5_are_read_alike(tmp_path: Path) -> None:
    path = tmp_path / "basin.mat"
    for version in ("4", "5"):
        savemat(path, COLUMNS, format=version, oned_as="row")
        assert np.array_equal(read(path).truth.position, POSITION[:1800])
    # As the author stores them: one variable of six rows, here behind others that are no vectors.
    stored = {"sim_x": POSITION.T, "t": TIME, "fs": 20.0, "note": "basin", "s": {"a": 1}}
    savemat(path, stored, do_compression=True)
    named = ",".join(f"{name}:sim_x_{i + 1}" for i, name in enumerate(DOF))
    assert np.array_equal(read(path, f"motion.columns=[{named}]").truth.position, POSITION[:1800])


def test_other_names_and_units(tmp_path: Path) -> None:
    angles = ("phi", "theta", "psi")
    told = {**COLUMNS, **{name: np.rad2deg(COLUMNS[name]) for name in angles}}
    told["SURGE"] = 1e3 * told.pop("x")
    with_units = {"SURGE": "mm", **dict.fromkeys(angles, "deg")}
    found = read(write(tmp_path, told, with_units), "motion.columns=[x:SURGE]").truth
    assert found.position == pytest.approx(POSITION[:1800], rel=1e-12)
    savemat(tmp_path / "basin.mat", told)
    words = "motion.columns=[x:SURGE:mm,phi:phi:deg,theta:theta:deg,psi:psi:deg]"
    found = read(tmp_path / "basin.mat", words).truth
    assert found.position == pytest.approx(POSITION[:1800], rel=1e-12)


def test_recorded_velocities_and_accelerations_take_the_place_of_derivatives(
    tmp_path: Path,
) -> None:
    more = {
        **COLUMNS, "u": 2.0 * VELOCITY[:, 0], "q": 60.0 * VELOCITY[:, 4], "az": ACCELERATION[:, 2],
    }  # fmt: skip
    truth = read(write(tmp_path, more, {"q": "deg/s", "az": "g"})).truth
    assert truth.velocity[:, 0] == pytest.approx(2.0 * VELOCITY[:1800, 0])
    assert truth.velocity[:, 4] == pytest.approx(np.pi / 3.0 * VELOCITY[:1800, 4])
    assert truth.acceleration[:, 2] == pytest.approx(9.80665 * ACCELERATION[:1800, 2])
    assert "'m/s' is a unit of velocity, not of angular velocity" in refusal(
        write(tmp_path, more, {"q": "m/s"})
    )


def test_rounded_times_are_equally_spaced(tmp_path: Path) -> None:
    thirds = np.arange(2000) / 300.0
    path = write(tmp_path, {**COLUMNS, "time": np.round(thirds, 4)})
    assert len(read(path, "record.rate=300", "record.duration=6", "record.settling=1")
               .truth.position) == 1800  # fmt: skip


def test_each_wrong_file_is_told_in_one_line_that_helps(tmp_path: Path) -> None:
    def changed(**columns):
        kept = {name: each for name, each in (COLUMNS | columns).items() if each is not None}
        return write(tmp_path, kept)

    assert "no column psi; it has time, x, y, z, phi, theta; set " in refusal(changed(psi=None))
    assert (
        "no time column found among x, y, z, phi, theta, psi: set motion.columns=[time:NAME]"
        in refusal(changed(time=None))
    )
    assert "motion.columns: 'speed:x' is not SIGNAL:NAME" in refusal(
        changed(), "motion.columns=[speed:x]"
    )
    assert "motion.columns=x:SURGE: no channel 'SURGE'; there are time, x, y, z, phi" in refusal(
        changed(), "motion.columns=[x:SURGE]"
    )
    zero = refusal(changed(z=np.zeros(2000)))
    assert "z (channel z) is 0 throughout" in zero
    assert "put small noise in its place" in zero
    assert "psi (channel psi) is 0.3 throughout" in refusal(changed(psi=np.full(2000, 0.3)))
    gap = POSITION[:, 1].copy()
    gap[700] = np.nan
    assert "y (channel y) has no number in data row 701 (1 such rows in all)" in refusal(
        changed(y=gap)
    )
    assert "time (time) goes backwards in data row 2" in refusal(changed(time=TIME[::-1]))
    late = TIME.copy()
    late[900:] += 6.0 * STEP
    assert "has gaps longer than 0.25 s: 44.95 s to 45.3 s; cut" in refusal(changed(time=late))
    assert "set record.rate=10" in refusal(changed(time=2.0 * TIME))
    assert "set record.duration=100" in refusal(changed(), "record.duration=101")
    assert "'kg' is not a unit known here" in refusal(write(tmp_path, units={"x": "kg"}))
    assert "'deg' is a unit of angle, not of length" in refusal(write(tmp_path, units={"x": "deg"}))
    steep = refusal(changed(theta=100.0 * COLUMNS["theta"]))
    assert "if angles are in degrees, say so: motion.columns=" in steep
    assert "give motion.file=" in refusal_without_file()
    roll = refusal(changed(), "plane=roll_snr", "grid.delay=[0]")
    assert "use grid.roll=null" in roll


def refusal_without_file() -> str:
    with pytest.raises(InputError) as caught:
        compose(WORDS)
    return str(caught.value)


def test_a_position_that_no_floater_reaches_is_refused(tmp_path: Path) -> None:
    damaged = COLUMNS["y"].copy()
    damaged[300] = 1e20
    told = refusal(write(tmp_path, {**COLUMNS, "y": damaged}))
    assert told.endswith(
        "basin.csv: y (channel y) holds 1e+20 in SI units, and no motion reaches 1e+09: check its "
        "unit, and mend or cut out damaged rows"
    )
