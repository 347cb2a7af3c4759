"""A record of a structure in the place of a simulated truth."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest

from owtsweep.config import changed
from owtsweep.errors import InputError
from owtsweep.structures import read_structure
from owtsweep.structures.bernoulli import assemble_cut
from owtsweep.studies.registry import compose
from owtsweep.studies.tower import measuring
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contest import describe_truth
from owtsweep.studies.tower.contract import Channel, Estimates
from owtsweep.studies.tower.measuring import list_places, take_signals
from owtsweep.studies.tower.recorded import (
    RecordedStructure,
    load_motions,
    make_motions,
    measure,
    read_record,
    require_channels,
)
from owtsweep.studies.tower.schemes import SCHEMES
from owtsweep.studies.tower.sections import Faults, Recorded
from owtsweep.studies.tower.setting import make_setting, model_substructure

ROOT = Path(__file__).parents[3]
MAST = read_structure(ROOT / "examples" / "mast.yaml")
CUT = assemble_cut(MAST, MAST.bottom, MAST.hub)
ROWS = 40
TIME = 0.01 * np.arange(ROWS)


def write(path: Path, **columns: np.ndarray) -> Path:
    """Write columns as a CSV file; `__` in a name stands for the bracket before a unit."""
    names = [f"{n.split('__')[0]} ({n.split('__')[1]})" if "__" in n else n for n in columns]
    np.savetxt(
        path, np.column_stack(list(columns.values())), "%.9g", ",", header=",".join(names),
        comments="",
    )  # fmt: skip
    return path


def configure(path: Path, duration: float, rate: float = 100.0) -> TowerConfig:
    """Return the configuration of a record of the mast from a file."""
    config = compose(["study=tower", "experiment=mast", f"structure={ROOT / 'examples/mast.yaml'}"])
    record = changed(config.record, duration=duration, rate=rate)
    return changed(config, record=record, recorded=Recorded(file=str(path)))


def read(path: Path, *columns: str) -> RecordedStructure:
    return read_record(Recorded(file=str(path), columns=list(columns)))


def test_columns_become_the_truth_in_si_units(tmp_path):
    ramp = np.arange(ROWS) + 1.0
    file = write(
        tmp_path / "r.csv", time__ms=1e3 * TIME, F_24__kN=ramp, M_0__MNm=ramp, a_012__g=ramp,
        theta_3__deg=ramp, x_24_ss__mm=ramp, v_24=ramp, strange=ramp,
    )  # fmt: skip
    record = read(file)
    assert record.found.step == pytest.approx(0.01)
    assert record.found.unused == ("strange",)
    motions = make_motions(record, CUT)
    assert list(motions) == ["fa", "ss"]
    np.testing.assert_allclose(motions["fa"].inputs[:, 2], 1e3 * ramp)
    np.testing.assert_allclose(motions["fa"].inputs[:, 1], 1e6 * ramp)
    np.testing.assert_allclose(motions["fa"].acceleration[:, 2 * 4], 9.80665 * ramp)
    np.testing.assert_allclose(motions["fa"].displacement[:, 2 * 1 + 1], np.deg2rad(ramp))
    np.testing.assert_allclose(motions["ss"].displacement[:, 2 * 8], 1e-3 * ramp)
    known = sum(int(np.isfinite(part).all(axis=0).sum()) for m in motions.values()
                for part in (m.inputs, m.displacement, m.acceleration))  # fmt: skip
    assert known == 5  # everything else is NaN


def test_a_users_names_and_units_are_translated(tmp_path):
    file = write(tmp_path / "r.csv", clock=TIME, ACC3=TIME, LOAD=TIME)
    record = read(file, "time:clock", "a_12:ACC3", "F_24: LOAD:kN")
    np.testing.assert_allclose(1e3 * record.found.values["a_12"], record.found.values["F_24"])
    for wrong, told in (
        (["a_12"], r"recorded.columns: 'a_12' is not SIGNAL:NAME or SIGNAL:NAME:UNIT; signals are"),
        (["time:clock", "a_12:ACC3", "a_12:LOAD"], "recorded.columns: a_12 is there twice for col"),
        (["time:clock", "a_12:ACC4"], r"columns=a_12:ACC4: no channel 'ACC4'; there are ACC3, "),
        (
            ["time:clock", "acc_12:ACC3"],
            r"columns: 'acc_12:ACC3' is not SIGNAL:NAME .* a_012",
        ),
        (
            ["a_12:ACC3"],
            "no time column found among clock, ACC3, LOAD: set recorded.columns=.t",
        ),
        (["time:clock"], "no column has a name such as a_012"),
        (["time:clock", "a_12:ACC3:mm"], r"=.a_12:NAME:UNIT.: 'mm' is a unit of length, not of ac"),
    ):
        with pytest.raises(InputError, match=told):
            read(file, *wrong)


def test_bad_columns_are_told_in_one_line(tmp_path):
    late, holes, ramp = TIME.copy(), TIME.copy(), TIME.copy()
    late[20:] += 0.06
    holes[[7, 9]] = np.nan
    for columns, told in (
        ({"time": late, "a_12": ramp}, r"time .time. has gaps longer than 0.05 s: 0.19"),
        ({"time": TIME[::-1], "a_12": ramp}, "goes backwards in data row 2"),
        ({"time": holes, "a_12": ramp}, r"time .time. is missing in data row 8"),
        ({"time": TIME, "a_12": holes}, r"a_12 .channel a_12. has no number in data row 8 .2"),
        ({"time": TIME, "a_12": 1e150 * ramp}, "a_12. holds 3.9e.149 in SI units, and no motion"),
        ({"time": TIME, "M_24": 1e150 * ramp}, "M_24. holds 3.9e.149 in SI units, and no load "),
        ({"time": TIME, "a_12__furlong": ramp}, "a_12 says its unit is: 'furlong' is not a unit"),
        ({"time": TIME, "a_12__mm": ramp}, "'mm' is a unit of length, not of acceleration"),
        ({"time": TIME, "F_24__lbf": ramp}, "'lbf' is not a unit known here: use one of N, kN, MN"),
        ({"time": TIME, "F_24__mN": ramp}, "'mN' is not a unit known here: use one of N, kN, MN"),
        ({"time": TIME[:9], "a_12": ramp[:9]}, "has 9 rows; at least 32 are needed"),
        ({"time": TIME, "a_12": ramp, "a_012": ramp}, "a_12 and a_012 are the same quantity"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=told) as error:
            read(write(tmp_path / "r.csv", **columns))
        assert "r.csv" in str(error.value)


def test_places_must_be_nodes_and_cuts(tmp_path):
    file = write(tmp_path / "r.csv", time=TIME, a_13=TIME)
    with pytest.raises(InputError, match=r"column a_13: no node .* 13 m .* nearest are at 12, "):
        make_motions(read(file), CUT)
    file = write(tmp_path / "r.csv", time=TIME, F_12=TIME)
    with pytest.raises(InputError, match=r"column F_12: at 12 m is no cut; .* 0 and 24 m"):
        make_motions(read(file), CUT)
    file = write(tmp_path / "r.csv", time=TIME, a_12=TIME)
    record = read(file)
    require_channels(record, CUT, "fa", [measuring.Place("a", 4)])
    with pytest.raises(InputError, match=r"no column a_015 of direction fa .* it has a_12; name"):
        require_channels(record, CUT, "fa", [measuring.Place("a", 5)])
    with pytest.raises(InputError, match="no channel of kind strain; use sensors of kind x, theta"):
        require_channels(record, CUT, "fa", [measuring.Place("strain", 4)])


def test_length_and_rate_are_those_of_the_study(tmp_path):
    file, places = write(tmp_path / "r.csv", time=TIME, a_12=TIME), [measuring.Place("a", 4)]
    motion = load_motions(configure(file, 0.35), CUT, places)["fa"]
    assert motion.acceleration.shape == (35, len(CUT.mass))
    with pytest.raises(InputError, match=r"record.rate: 50 Hz, but .* every 0.01 s; .*rate=100"):
        load_motions(configure(file, 0.7, 50.0), CUT, places)
    with pytest.raises(InputError, match=r"record.duration: 0.41 s, but .* lasts 0.4 s; set rec"):
        load_motions(configure(file, 0.41), CUT, places)


def test_a_record_is_judged_by_what_it_holds_and_the_answer_names_it(tmp_path):
    script = runpy.run_path(str(ROOT / "experiments" / "tower" / "make_recorded.py"))
    script["write"](script["make"](MAST, 500), tmp_path / "mast.csv")
    words = [
        "study=tower", "experiment=mast", f"structure={ROOT / 'examples' / 'mast.yaml'}",
        f"recorded.file={tmp_path / 'mast.csv'}", "record.duration=5", "record.settling=1",
    ]  # fmt: skip
    told = describe_truth(compose(words))
    assert told == "mast, this motion of mast.csv alone, with noise drawn anew, 5 s"
    with pytest.raises(InputError, match="to judge base_moment by; use criterion=displacement"):
        compose([*words, "criterion=base_moment"])


def test_only_what_is_known_is_compared(tmp_path):
    wave = np.sin(TIME)
    file = write(tmp_path / "r.csv", time=TIME, F_24=wave, x_12=wave)
    motion = make_motions(read(file), CUT)["fa"]
    dof = len(CUT.mass)
    guess = Estimates(np.tile(0.9 * wave[:, None], dof), np.tile(wave[:, None], 4))
    worst = measure({"fa": motion}, {"fa": guess}, CUT, 5)
    assert worst == pytest.approx({"F_024_fa": 0.0, "x_012_fa": 0.1, "displacement": 0.1}, abs=1e-7)


def test_errors_are_divided_by_what_the_maps_title_says(tmp_path):
    """ "Std of its error over its own std": an offset of signal or error counts in neither."""
    wave = np.sin(20.0 * TIME)
    file = write(tmp_path / "r.csv", time=TIME, M_0=50.0 + wave, x_12=3.0 + wave, F_24=TIME**0)
    motion = make_motions(read(file), CUT)["fa"]
    dof = len(CUT.mass)
    guess = Estimates(np.tile(7.0 + 0.9 * wave[:, None], dof), np.tile(1.2 * wave[:, None], 4))
    found = measure({"fa": motion}, {"fa": guess}, CUT, 5)
    assert found == pytest.approx(
        {"M_000_fa": 0.2, "x_012_fa": 0.1, "displacement": 0.1, "base_moment": 0.2}, abs=1e-6
    )  # a constant force has no deviation, so it is left out


def test_the_mast_of_the_project_is_always_the_same(tmp_path):
    script = runpy.run_path(str(ROOT / "experiments" / "tower" / "make_recorded.py"))
    columns = script["make"](MAST, 1500)
    assert columns["F_024 (N)"].shape == (1500,)
    inner = slice(200, -1)  # the shaker begins with a jerk
    for place, rate in (("x_021 (m)", "v_021 (m/s)"), ("v_021 (m/s)", "a_021 (m/s^2)")):
        slope = np.gradient(columns[place], script["STEP"])[inner]
        np.testing.assert_allclose(slope, columns[rate][inner], atol=0.02 * np.abs(slope).max())
    script["write"](columns, tmp_path / "a.csv")
    script["write"](script["make"](MAST, 1500), tmp_path / "b.csv")
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    assert make_motions(read(tmp_path / "a.csv"), CUT)["fa"].inputs[:, 2].std() > 100.0


def test_force_and_motion_of_the_mast_come_back(tmp_path):
    script = runpy.run_path(str(ROOT / "experiments" / "tower" / "make_recorded.py"))
    script["write"](script["make"](MAST, 5000), tmp_path / "mast.csv")
    config = configure(tmp_path / "mast.csv", 50.0)
    part = model_substructure(config)
    places = list_places(config.sensors, config.nodes)
    motion = load_motions(config, part.cut, places)["fa"]
    signals = take_signals(motion, part.strain, places, Faults())
    sigma = 0.01 * signals.std(axis=0)
    channels = [Channel(*place[:2], s) for place, s in zip(places, sigma, strict=True)]
    setting = make_setting(config, part, "fa", 1.0, channels, None)
    noise = np.random.default_rng(3).standard_normal(signals.shape)
    guess = SCHEMES.resolve("AKF_STEADY").prepare(setting).run(signals + sigma * noise)
    errors = measure({"fa": motion}, {"fa": guess}, part.cut, config.record.settled)
    assert len(errors) == 2 + 2 * 8  # force, displacement and rotation of eight nodes, the worst
    assert max(errors.values()) == errors["F_024_fa"] < 0.05
    assert max(error for name, error in errors.items() if name != "F_024_fa") < 0.02
