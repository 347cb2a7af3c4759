"""A recorded lift: files of a simulated one go through the same estimators."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from pymap3d import enu2geodetic
from pynmeagps import GET, NMEAMessage
from pynmeagps.nmeahelpers import calc_checksum
from scipy.spatial.transform import Rotation

import owtsweep
from owtsweep.evaluation.estimate import EstimatedRecord
from owtsweep.motion.recorded import describe, open_table
from owtsweep.studies import compose
from owtsweep.studies.blade.recorded_case import read_antenna

SHORT = [
    "unit=fog", "record.duration=60", "record.settling=20", "sensors.outage_every=40",
    "schemes=[HOLD,MEKF]",
]  # fmt: skip
RECORDED = ["study=blade", "experiment=recorded", *SHORT, "recorded.imu=imu.csv"]
CELL = ["grid.sigma=[0.006]", "grid.outage=[10]"]
#: Turns x, y, z of the frame into east, north, up.
TO_ENU = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
ORIGIN = (53.5, 8.1, 40.0)


@pytest.fixture(scope="module")
def lift() -> EstimatedRecord:
    return owtsweep.estimate(["study=blade", *SHORT, "grid.sigma=[0.006]", "grid.outage=[0]"])


@pytest.fixture(scope="module")
def folder(lift: EstimatedRecord, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The lift as tables, on the globe and as NMEA, with a clock that begins at 100 s."""
    folder = tmp_path_factory.mktemp("lift")
    imu = {"time": 100.0 + lift.time}
    for names, signal in (("fx fy fz", "specific_force"), ("wx wy wz", "rate")):
        for name, column in zip(names.split(), lift.measurements[signal].value.T, strict=True):
            imu[name] = column
    pd.DataFrame(imu).to_csv(folder / "imu.csv", index=False)
    time, fixes = lift.measurements["fixes"]
    for k in range(3):
        table = pd.DataFrame(fixes[:, k], columns=["x", "y", "z"])
        table.insert(0, "time", 100.0 + time)
        table.to_csv(folder / f"gnss{k}.csv", index=False)
    enu = fixes[:, 0] @ TO_ENU.T
    globe = np.column_stack(enu2geodetic(*enu.T, *ORIGIN))
    table = pd.DataFrame(globe, columns=["latitude", "longitude", "height"])
    table.insert(0, "time", 100.0 + time)
    table.to_csv(folder / "globe.csv", index=False)
    for quality in (4, 5):
        (folder / f"quality{quality}.nmea").write_bytes(_sentences(table, quality))
    return folder


@pytest.fixture(scope="module")
def plain(folder: Path) -> EstimatedRecord:
    """The estimates from the table of one antenna."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        return _run("recorded.gnss=[gnss0.csv]", "recorded.heading=0")


@pytest.fixture(autouse=True)
def _files(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Work among copies of the files."""
    monkeypatch.chdir(tmp_path)
    for file in folder.iterdir():
        shutil.copy(file, tmp_path)


def _run(*words: str) -> EstimatedRecord:
    return owtsweep.estimate([*RECORDED, *CELL, *words])


def _sentences(globe: pd.DataFrame, quality: int) -> bytes:
    sentences = []
    for time, lat, lon, height in globe.to_numpy():
        clock = f"00{int(time // 60):02d}{time % 60:05.2f}"
        sentences.append(
            NMEAMessage(
                "GN", "GGA", GET, time=clock, lat=lat, NS="N", lon=lon, EW="E", quality=quality,
                numSV=12, HDOP=0.7, alt=round(height - 38.0, 3), altUnit="M", sep=38.0,
                sepUnit="M", hpnmeamode=1,
            ).serialize()
        )  # fmt: skip
    return b"".join(sentences)


def _write_nmea(quality: int = 4) -> None:
    shutil.copy(f"quality{quality}.nmea", "fixes.nmea")


def test_tables_give_what_the_simulation_gave(lift: EstimatedRecord) -> None:
    attitude = Rotation.from_matrix(lift.truth["rotation"][0]).as_quat(scalar_first=True)
    known = f"recorded.attitude=[{','.join(map(repr, attitude.tolist()))}]"
    sure = ["recorded.tilt_sigma=0.01", "recorded.heading_sigma=0.01"]
    found = _run("recorded.gnss=[gnss0.csv,gnss1.csv,gnss2.csv]", known, *sure)
    for name in ("specific_force", "rate"):
        expected = lift.measurements[name].value
        np.testing.assert_allclose(found.measurements[name].value, expected, atol=1e-12)
    error = found.estimates["MEKF"]["root"] - lift.truth["root"]
    before = lift.estimates["MEKF"]["root"] - lift.truth["root"]
    part = slice(1500, 2450)
    assert np.sqrt(np.mean(error[part] ** 2)) < 1.2 * np.sqrt(np.mean(before[part] ** 2))


def test_the_heading_of_two_antennas_is_that_of_the_truth(lift: EstimatedRecord) -> None:
    found = _run("recorded.gnss=[gnss0.csv,gnss1.csv]", "schemes=[MEKF_HEADING]")
    turned = Rotation.from_matrix(
        found.estimates["MEKF_HEADING"]["rotation"][-501] @ lift.truth["rotation"][-501].T
    ).magnitude()
    assert np.rad2deg(turned) < 0.3


def test_a_given_heading_tilts_as_gravity_says(lift: EstimatedRecord) -> None:
    angles = Rotation.from_matrix(lift.truth["rotation"][0]).as_euler("ZYX", degrees=True)
    found = _run("recorded.gnss=[gnss0.csv]", f"recorded.heading={-angles[0]}")
    first = found.estimates["MEKF"]["rotation"][0]
    turned = Rotation.from_matrix(first @ lift.truth["rotation"][0].T).magnitude()
    assert np.rad2deg(turned) < 1.5  # the blade swings while it is levelled


@pytest.mark.parametrize("kind", ["globe", "nmea"])
def test_positions_on_the_globe_are_those_of_the_table(kind: str, plain: EstimatedRecord) -> None:
    if kind == "nmea":
        _write_nmea()
    file = "fixes.nmea" if kind == "nmea" else "globe.csv"
    globe = _run(f"recorded.gnss=[{file}]", "recorded.heading=0")
    apart = globe.estimates["MEKF"]["root"] - plain.estimates["MEKF"]["root"]
    apart -= apart[1500:2400].mean(axis=0)  # another origin
    assert np.abs(apart[1500:2400]).max() < (2e-3 if kind == "nmea" else 1e-4)


def test_float_solutions_of_nmea_are_told() -> None:

    _write_nmea(quality=5)
    fixes = read_antenna(open_table("fixes.nmea"), [])
    assert fixes.floating.all()
    assert fixes.time[0] == pytest.approx(100.0)
    size = {}
    for quality in (4, 5):
        _write_nmea(quality)
        found = _run("recorded.gnss=[fixes.nmea]", "recorded.heading=0")
        size[quality] = np.trace(found.covariances["MEKF"]["root"][-501])
    assert size[5] > 2.0 * size[4]


def test_columns_units_mounting_and_a_shifted_clock(plain: EstimatedRecord) -> None:
    imu, gnss = pd.read_csv("imu.csv"), pd.read_csv("gnss0.csv")
    turned = imu.copy()
    for a, b in (("fx", "fy"), ("wx", "wy")):  # the unit's x is the blade's y, its y minus x
        turned[a], turned[b] = imu[b], -imu[a]
    turned[["wx", "wy", "wz"]] = np.rad2deg(turned[["wx", "wy", "wz"]])
    turned = turned.rename(columns={"wx": "wx (deg/s)", "wy": "wy (deg/s)", "wz": "gyro"})
    turned.to_csv("imu.csv", index=False)
    gnss.assign(time=gnss["time"] - 30.0).rename(columns={"x": "east"}).to_csv(
        "gnss0.csv", index=False
    )
    found = _run(
        "recorded.gnss=[gnss0.csv]", "recorded.heading=0", "recorded.shift=30",
        "recorded.mounting=[[0,-1,0],[1,0,0],[0,0,1]]", "recorded.columns=[wz:gyro:deg/s,x:east]",
    )  # fmt: skip
    np.testing.assert_allclose(
        found.estimates["MEKF"]["root"], plain.estimates["MEKF"]["root"], atol=1e-6
    )


def test_a_sweep_judges_against_withheld_fixes() -> None:
    run = owtsweep.run([
        *RECORDED, "grid.outage=[0,10]", "recorded.gnss=[gnss0.csv,gnss1.csv]",
        "schemes=[HOLD,MEKF,GNSS_WAHBA,TOTAL_STATIONS]",
        "compute.backend=threading",  # processes that another test left stand in its folder
    ])  # fmt: skip
    rows = run.cases()
    withheld = rows[rows["measure"] == "withheld"].set_index("scheme")["value"]
    assert set(rows[rows["measure"] == "withheld"]["outage"]) == {10.0}
    assert withheld["MEKF"] < 0.2 < withheld["HOLD"]
    unable = rows[rows["status"] == "unable"]
    assert set(unable["scheme"].astype(str)) == {"GNSS_WAHBA", "TOTAL_STATIONS"}
    assert "needs 3 antennas, and the record has 2" in set(unable["reason"].astype(str))


def _change(file: str, column: str, row: int, value: float) -> None:
    table = pd.read_csv(file)
    table.loc[row, column] = value
    table.to_csv(file, index=False)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["recorded.gnss=[]"], "recorded.gnss: 0 files for the 3 places"),
        (["recorded.gnss=[gnss0.csv]"], "recorded.heading: the heading is unknown, and cannot be "),
        (["recorded.attitude=[0,0,0,0]"], "recorded.attitude: a quaternion of norm 0; give four "),
        (
            ["recorded.mounting=[[1,0,0],[0,1,0.1],[0,0,1]]"],
            "recorded.mounting: the rows are no rotation; ",
        ),
        (["recorded.mounting=[[1,0,0],[0,1,0],[0,0,-1]]"], "recorded.mounting: the rows are no "),
        (["record.rate=100"], "record.rate: 100 Hz, but imu.csv has a row every 0.02 s; "),
        (["record.duration=90"], "record.duration: 90 s, but imu.csv lasts 60 s; set record."),
        (["recorded.shift=1000"], "gnss0.csv: fewer than two fixes fall into the time of imu.csv"),
        (["recorded.imu=other.csv"], "other.csv: "),
        (["recorded.columns=[speed:v]"], "recorded.columns: 'speed:v' is not SIGNAL:NAME"),
        (
            ["recorded.columns=[wz:gyroz]"],
            "imu.csv: recorded.columns=wz:gyroz: no channel 'gyroz'; there are ",
        ),
        (
            ["recorded.columns=[x:fx]"],
            "gnss0.csv: recorded.columns=x:fx: no channel 'fx'; there are x, ",
        ),
        (["recorded.imu="], "recorded.imu: name the table of the inertial unit, e.g. "),
        (["grid.replicates=2"], "grid.replicates: 2, but one lift was recorded; "),
        (["grid.lever=[0.1]"], "grid.lever: a recorded lift has its own; "),
        (["recorded.gnss=[gnss0.csv,globe.csv]"], "recorded.gnss: some files have x, y, z and "),
    ],
)
def test_what_a_record_cannot_be(words: list[str], told: str) -> None:
    given = ["recorded.gnss=[gnss0.csv]", "recorded.heading=0"]
    if "heading is unknown" in told:
        given = given[:1]
    with pytest.raises(owtsweep.InputError) as error:
        compose([*RECORDED, *CELL, *given, *words])
    assert str(error.value).startswith(told)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("file", "column", "value", "told"),
    [
        (
            "imu.csv",
            "fx",
            np.nan,
            "imu.csv: fx (channel fx) has no number in data row 8 (1 such ",
        ),
        ("imu.csv", "time", 3.0, "imu.csv: time (time) goes backwards in data row 8: "),
        ("gnss0.csv", "time", 3.0, "gnss0.csv: time (time) goes backwards in data row 8: "),
        (
            "imu.csv",
            "fy",
            1e150,
            "imu.csv: fy (channel fy) holds 1e+150 in SI units, and no motion reaches 1e+09",
        ),
        (
            "gnss0.csv",
            "y",
            1e20,
            "gnss0.csv: y (channel y) holds 1e+20 in SI units, and no motion reaches 1e+09",
        ),
        (
            "globe.csv",
            "height",
            -1e20,
            "globe.csv: height (channel height) holds 1e+20 in SI ",
        ),
        ("globe.csv", "latitude", 95.0, "globe.csv: a latitude of 95 degrees in data row 8; "),
    ],
)
def test_bad_numbers_in_files(file: str, column: str, value: float, told: str) -> None:
    _change(file, column, 7, value)
    gnss = file if file != "imu.csv" else "gnss0.csv"
    with pytest.raises(owtsweep.InputError) as error:
        compose([*RECORDED, *CELL, f"recorded.gnss=[{gnss}]", "recorded.heading=0"])
    assert str(error.value).startswith(told)


def test_fixes_faster_than_the_unit_are_refused() -> None:
    table = pd.read_csv("gnss0.csv")
    table.assign(time=100.0 + 0.004 * np.arange(len(table))).to_csv("gnss0.csv", index=False)
    with pytest.raises(owtsweep.InputError, match=r"a fix every 0.004 s is faster than the"):
        compose([*RECORDED, *CELL, "recorded.gnss=[gnss0.csv]", "recorded.heading=0"])


def test_a_lift_with_dates_for_times_is_refused() -> None:
    """They become seconds from the first of each file, and the files begin at different times."""
    table = pd.read_csv("gnss0.csv")
    dates = pd.Timestamp("2024-05-01") + pd.to_timedelta(table["time"], unit="s")
    table.assign(time=dates.dt.strftime("%Y-%m-%dT%H:%M:%S.%fZ")).to_csv("gnss0.csv", index=False)
    with pytest.raises(owtsweep.InputError, match=r"^gnss0.csv: its times are dates, which become"):
        compose([*RECORDED, *CELL, "recorded.gnss=[gnss0.csv]", "recorded.heading=0"])


def test_sentences_are_described_as_a_table() -> None:
    _write_nmea()
    told = describe("fixes.nmea")
    assert "NMEA, GGA sentences, 5 channels" in told
    assert "time (time): 100 s to" in told


def test_an_inertial_unit_with_jitter_and_missing_rows_is_resampled(
    plain: EstimatedRecord, caplog: pytest.LogCaptureFixture
) -> None:
    imu = pd.read_csv("imu.csv").drop(index=[700, 701, 1500])
    imu.to_csv("imu.csv", index=False)
    found = _run("recorded.gnss=[gnss0.csv]", "recorded.heading=0")
    assert "imu.csv: 3 rows are missing: filled by cubic spline" in caplog.text
    apart = found.estimates["MEKF"]["root"] - plain.estimates["MEKF"]["root"]
    assert np.abs(apart).max() < 0.01


def test_antennas_in_a_line_do_not_show_an_attitude() -> None:
    line = "recorded.antennas=[[-16,0,2],[0,0,2],[5,0,2]]"
    files = "recorded.gnss=[gnss0.csv,gnss1.csv,gnss2.csv]"
    with pytest.raises(owtsweep.InputError, match="collinear"):
        _run(files, line, "recorded.heading=0", "schemes=[GNSS_WAHBA]")


def test_a_damaged_sentence_is_refused() -> None:
    _write_nmea()
    text = Path("fixes.nmea").read_bytes()
    Path("fixes.nmea").write_bytes(text.replace(b"GNGGA", b"GNGGX", 1))
    with pytest.raises(owtsweep.InputError, match=r"^fixes.nmea: sentence 1 cannot be read"):
        compose([*RECORDED, *CELL, "recorded.gnss=[fixes.nmea]", "recorded.heading=0"])


def _edit_nmea(edit: Callable[[list[str]], None], first: int = 0, count: int = 10**9) -> None:
    """Change the fields of some sentences (0: GNGGA, 1: time, ...), and make their sums right."""
    lines = Path("fixes.nmea").read_text().splitlines()
    for i in range(first, min(first + count, len(lines))):
        fields = lines[i][1:].partition("*")[0].split(",")
        edit(fields)
        body = ",".join(fields)
        lines[i] = f"${body}*{calc_checksum(body)}"
    Path("fixes.nmea").write_text("\r\n".join(lines) + "\r\n")


def test_an_empty_geoid_separation_is_read() -> None:
    """Heights are altitudes then: all differ by the separation, so nothing else does."""
    _write_nmea()
    whole = read_antenna(open_table("fixes.nmea"), [])
    _edit_nmea(lambda fields: fields.__setitem__(slice(11, 13), ["", ""]))
    fixes = read_antenna(open_table("fixes.nmea"), [])
    assert np.allclose(whole.position - fixes.position, [0.0, 0.0, 38.0], atol=1e-9)
    assert (fixes.time == whole.time).all()


def test_a_cut_sentence_is_one_line() -> None:
    _write_nmea()
    _edit_nmea(lambda fields: fields.__delitem__(slice(3, None)), first=2, count=1)
    told = r"GGA sentence 3 with a fix has no readable"
    with pytest.raises(owtsweep.InputError, match=told):
        read_antenna(open_table("fixes.nmea"), [])


def test_heights_above_the_geoid_and_above_the_ellipsoid_are_not_mixed() -> None:
    _write_nmea()
    Path("whole.nmea").write_bytes(Path("fixes.nmea").read_bytes())
    _edit_nmea(lambda fields: fields.__setitem__(slice(11, 13), ["", ""]))
    told = r"^recorded.gnss: no sentence of fixes.nmea states the geoid's separation"
    with pytest.raises(owtsweep.InputError, match=told):
        compose([*RECORDED, *CELL, "recorded.gnss=[whole.nmea,fixes.nmea]"])


@pytest.mark.parametrize(
    ("field", "value", "says"),
    [
        (1, "996140.00", "GGA sentence 3 with a fix has no readable time; cut damaged"),
        (1, "", "GGA sentence 3 with a fix has no readable time; cut damaged"),
        (6, "", "GGA sentence 3 with a fix has no readable quality; cut damaged"),
        (6, "99", "GGA sentence 3 has the quality 99, and NMEA has 0 to 9"),
        (6, "x", "sentence 3 cannot be read (Incorrect type for attribute quality"),
        (2, "", "GGA sentence 3 with a fix has no readable latitude; cut damaged"),
        (9, "", "GGA sentence 3 with a fix has no readable height; cut damaged"),
        (9, "nan", "GGA sentence 3 with a fix has no readable height; cut damaged"),
        (11, "nan", "GGA sentence 3 with a fix has no readable height; cut damaged"),
        (11, "", "some GGA sentences have a geoid separation and others have none"),
    ],
)
def test_a_bad_field_of_nmea_is_one_line(field: int, value: str, says: str) -> None:
    _write_nmea()
    _edit_nmea(lambda fields: fields.__setitem__(field, value), first=2, count=1)
    with pytest.raises(owtsweep.InputError, match="^fixes.nmea: " + re.escape(says)) as error:
        read_antenna(open_table("fixes.nmea"), [])
    assert "\n" not in str(error.value)


def test_the_experiment_needs_a_file() -> None:
    """Else a lift would be simulated that nobody asked for."""
    with pytest.raises(owtsweep.InputError, match=r"^recorded.imu: name the table"):
        compose(["study=blade", "experiment=recorded"])
    with pytest.raises(owtsweep.InputError, match=r"^recorded.imu: name the table"):
        compose(["study=blade", "experiment=recorded", "recorded.gnss=[gnss0.csv]"])


def test_a_column_of_one_antenna_alone_is_enough() -> None:
    """The items serve all files: the second antenna's table calls its x by its own name."""
    pd.read_csv("gnss1.csv").rename(columns={"x": "east"}).to_csv("gnss1.csv", index=False)
    compose([*RECORDED, *CELL, "recorded.gnss=[gnss0.csv,gnss1.csv]", "recorded.columns=[x:east]"])


def _hoist(speed: float) -> None:
    """Raise the hook at a speed in m/s: forces and rates stay."""
    table = pd.read_csv("gnss0.csv")
    table.assign(z=table["z"] + speed * table["time"]).to_csv("gnss0.csv", index=False)


@pytest.mark.parametrize(
    ("speed", "schemes", "warned"),
    [(0.0, "MEKF,PENDULUM", False), (0.02, "MEKF,PENDULUM", True), (0.02, "MEKF", False)],
)
def test_a_hook_that_moves_is_warned_of_if_pendulum_runs(
    speed: float, schemes: str, warned: bool, caplog: pytest.LogCaptureFixture
) -> None:
    _hoist(speed)
    words = ["recorded.gnss=[gnss0.csv]", "recorded.heading=0", f"schemes=[{schemes}]"]
    owtsweep.run([*RECORDED, *CELL, *words, "compute=single"])
    told = [r.getMessage() for r in caplog.records if "the hook moves" in r.getMessage()]
    assert len(told) == warned
    if warned:
        assert told[0].startswith("PENDULUM: the hook moves by 1.1")  # 60 s less a period of 5 s
        assert "m along z, and PENDULUM is for a hook at rest" in told[0]


@pytest.mark.parametrize(
    ("words", "key"),
    [
        (["unit=fog"], "unit"),
        (["unit=tactical"], "unit"),
        (["unit=mems"], None),
        (["unit=fog", "unit.rate_bias=0.0042"], None),
        (["unit=mems", "tuning=paper"], "filters"),
        (["unit=fog", "tuning=paper", "filters.rate_bias=0.0042"], None),
    ],
)
def test_a_good_unit_on_a_turning_earth_is_warned_of(
    words: list[str], key: str | None, caplog: pytest.LogCaptureFixture
) -> None:
    from owtsweep.studies.blade.doubts import warn_of_doubts

    given = ["recorded.gnss=[gnss0.csv]", "recorded.heading=0", "schemes=[MEKF]"]
    warn_of_doubts(compose([*RECORDED, *CELL, *given, *words]))
    told = [r.getMessage() for r in caplog.records if "Earth's rotation" in r.getMessage()]
    assert len(told) == (key is not None)
    if key:
        assert told[0].startswith(f"{key}.rate_bias: Earth's rotation, 15 deg/h, is left out, ")
        assert f"set {key}.rate_bias=0.0042" in told[0]


def test_a_lever_arm_of_a_kilometre_is_warned_of(caplog: pytest.LogCaptureFixture) -> None:
    from owtsweep.studies.blade.doubts import warn_of_doubts

    far = "recorded.antennas=[[1000,0,2]]"
    config = compose([*RECORDED, *CELL, "recorded.gnss=[gnss0.csv]", "recorded.heading=0", far])
    warn_of_doubts(config)
    assert "an antenna is 1016 m from the inertial unit; are the places in m?" in caplog.text
