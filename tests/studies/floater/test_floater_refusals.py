"""Bad input of the floater study: one line that says what works, and what it says does work."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from linear_records import STEP, move
from scipy.io import savemat

from owtsweep.cli import main
from owtsweep.studies import compose
from owtsweep.studies.floater.contest import CONTEST
from owtsweep.studies.floater.contract import DOF
from owtsweep.studies.floater.measuring import measure
from owtsweep.studies.floater.truth import make_truth

TINY = [
    "study=floater", "record.duration=60", "record.rate=20", "record.settling=20",
    "grid.delay=[0]", "grid.bias=[0.0]", "grid.replicates=1", "schemes=[KF]", "compute.workers=1",
]  # fmt: skip
ROLL = ["plane=roll_snr", "schemes=[KF]", "grid.snr=[20]"]
LOSS = ["plane=snr_loss", "grid.snr=[20]"]


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def refusal(words: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """Return the one line of a run that is refused; nothing is written."""
    assert main(["sweep", *TINY, *words]) == 2
    told = capsys.readouterr()
    assert re.fullmatch(r"owtsweep: .*\n", told.err), told.err
    assert not Path("results").exists()
    return told.err.strip()


#: What is wrong, what is said, and what it says would work (None: no such words or number).
SENSORS = [
    (["grid.snr=[nan]"], r"grid\.snr\[0\]: nan dB must be a finite number", None),
    (["grid.snr=[inf]"], r"grid\.snr\[0\]: inf dB must be a finite number", None),
    (["grid.snr=[5000]"], r"grid\.snr: give -100 to 400 dB", ["grid.snr=[400]"]),
    (["grid.snr=[-101]"], r"grid\.snr: give -100 to 400 dB", ["grid.snr=[-100]"]),
    ([*LOSS, "grid.loss=[0,1]"], r"grid\.loss: 1 leaves no report; give shares below 1",
     [*LOSS, "grid.loss=[0,0.9]"]),
    (["grid.loss=[-0.1]"], r"grid\.loss\[0\]: -0\.1 .*zero or above", None),
    (["sensors.loss_length=60"], r"sensors\.loss_length: 60 s are not shorter than the record of "
     r"60 s; give less", None),
    (["sensors.loss_every=0.3"], r"sensors\.loss_every: a loss of 0\.5 s every 0\.3 s leaves no "
     r"report; give 0\.55 s or more", ["sensors.loss_every=0.55"]),
    (["sensors.loss_every=0.51"], r"give 0\.55 s or more", None),  # ten samples, as the loss
    (["sensors.loss_every=60"], r"sensors\.loss_every: no loss comes every 60 s in a record of "
     r"60 s; give less", None),
    ([*LOSS, "grid.loss=[0,0.1]", "sensors.loss_every=20"],
     r"grid\.loss: with losses every 20 s .* use grid\.loss=\[0\]",
     [*LOSS, "grid.loss=[0]", "sensors.loss_every=20"]),
    (["sensors.optical_rate=20.1"], r"sensors\.optical_rate: 20\.1 Hz is above record\.rate, 20 "
     r"Hz; give at most that", ["sensors.optical_rate=20", "sensors.jitter=1"]),
    (["sensors.optical_rate=0.15"], r"sensors\.optical_rate: 0\.15 Hz does not show motion of 0\.1 "
     r"Hz .*; give more than 0\.2 Hz", ["sensors.optical_rate=0.21"]),
    (["motion=decay", "sensors.optical_rate=1.5"], r"motion of 0\.769 Hz .* more than 1\.54 Hz",
     None),
    (["sensors.jitter=1.5"], r"sensors\.jitter: 1.5 is more than 1", None),
    (["sensors.sigma=[1,2,3]"], r"sensors\.sigma: \[1, 2, 3\] must be six numbers, those of x",
     ["sensors.sigma=[1,2,3,1,2,3]"]),
    (["grid.delay=[0,601]"], r"grid\.delay: 601 samples are more than half of the record's 1200; "
     r"give at most 600", ["grid.delay=[0,600]"]),
    (["grid.delay=[1e9]"], r"grid\.delay: 1e\+09 samples are more", None),
]  # fmt: skip
MOTIONS = [
    ([*ROLL, "grid.roll=[1,40]"], r"grid\.roll: 40 deg reaches 90 deg, where Euler angles fail "
     r"\(KF\); give at most 29, or schemes=\[ERROR_STATE\]", [*ROLL, "grid.roll=[1,29]"]),
    ([*ROLL, "grid.roll=[1,40]"], r"or schemes=\[ERROR_STATE\]",
     [*ROLL, "grid.roll=[1,40]", "schemes=[ERROR_STATE]"]),
    ([*ROLL, "grid.roll=[70]", "schemes=[ERROR_STATE]"], r"grid\.roll: 70 deg reaches 180 deg; "
     r"give at most 59", [*ROLL, "grid.roll=[59]", "schemes=[ERROR_STATE]"]),
    ([*ROLL, "motion=decay", "grid.roll=[90]"], r"grid\.roll: 90 deg reaches 90 deg.*at most 89",
     [*ROLL, "motion=decay", "grid.roll=[89]"]),
    (["motion.freedoms.phi.resonance.sigma=30"], r"motion\.freedoms\.phi: a mean of 0\.2 deg and 90"
     r" deg about it reach 90 deg.* give less motion, or schemes=\[ERROR_STATE\]",
     None),
    (["motion.freedoms.theta.mean=88", "schemes=[ERROR_STATE]"], r"motion\.freedoms\.theta: a mean "
     r"of 88 deg and 3\.79 deg about it reach 90 deg", None),
    (["+motion.freedoms.surge.mean=1"], r"motion\.freedoms: no degree of freedom is called surge; "
     r"use x, y, z, phi, theta, psi", None),
    (["~motion.freedoms.psi"], r"motion\.freedoms: psi is missing; give all of x, y, z, phi, theta",
     None),
    (["motion.freedoms.psi.resonance.sigma=0", "motion.freedoms.psi.waves=0"],
     r"motion\.freedoms\.psi: it does not move, .* give it a small motion",
     ["motion.freedoms.psi.resonance.sigma=0", "motion.freedoms.psi.waves=1e-6"]),
    (["motion.freedoms.z.resonance.damping=1"], r"motion\.freedoms\.z\.resonance\.damping: 1 must "
     "be below 1", None),
    (["motion=buoy", "record.duration=60", "record.rate=4"], r"record\.rate: 4 Hz cannot show "
     r"motion up to 2\.308 Hz \(z\); give 4\.616 Hz or more",
     ["motion=buoy", "record.duration=60", "record.rate=4.616"]),
    (["axes=[delay]"], r"axes: \['delay'\] must be two axes, e\.g\. \[delay,bias\]",
     None),
]  # fmt: skip


@pytest.mark.parametrize(("words", "says", "right"), SENSORS + MOTIONS)
def test_bad_input_is_one_line_that_says_what_works(
    words: list[str], says: str, right: list[str] | None, capsys: pytest.CaptureFixture[str]
) -> None:
    assert re.search(says, refusal(words, capsys))
    if right is not None:
        compose([*TINY, *right])


COLUMNS = dict(zip(DOF, move(STEP * np.arange(1300), 1)[0].T, strict=True))
COLUMNS["time"] = STEP * np.arange(1300)
RECORDED = ["motion.kind=recorded", "motion.file=basin.mat"]


def test_a_matlab_file_of_version_7_3_that_is_cut_is_refused(
    capsys: pytest.CaptureFixture[str],
) -> None:
    header = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512)
    Path("basin.mat").write_bytes(header + b"\x89HDF\r\n\x1a\n" + bytes(1000))
    told = refusal(RECORDED, capsys)
    assert "basin.mat: is not a whole HDF5 file" in told
    savemat("basin.mat", COLUMNS)  # version 5 to 7
    compose([*TINY, *RECORDED])


def test_a_zero_column_of_a_file_says_what_to_do(capsys: pytest.CaptureFixture[str]) -> None:
    savemat("basin.mat", {**COLUMNS, "psi": np.zeros(1300)})
    told = refusal(RECORDED, capsys)
    assert "psi (channel psi) is 0 throughout" in told
    assert "put small noise in its place" in told
    noise = 1e-4 * np.random.default_rng(1).standard_normal(1300)
    savemat("basin.mat", {**COLUMNS, "psi": noise})
    compose([*TINY, *RECORDED])


def test_what_a_missing_or_short_file_needs(capsys: pytest.CaptureFixture[str]) -> None:
    assert "there is no such file" in refusal(RECORDED, capsys)
    assert "give motion.file=basin.csv" in refusal(RECORDED[:1], capsys)
    savemat("basin.mat", COLUMNS)
    assert "set record.duration=65" in refusal([*RECORDED, "record.duration=65.1"], capsys)
    assert "set record.rate=20" in refusal([*RECORDED, "record.rate=19"], capsys)
    compose([*TINY, *RECORDED, "record.duration=65"])


def test_a_delay_between_samples_is_interpolated() -> None:
    """It is not refused; test_floater_measuring has it against a closed form."""
    savemat("basin.mat", COLUMNS)
    config = compose([*TINY, *RECORDED, "grid.delay=[2.5]", "grid.snr=[400]"])
    seen = measure(config, make_truth(config, 0), CONTEST.list_cells(config)[0]).position
    between = move(STEP * (np.arange(1200) - 2.5), 1)[0]
    assert seen[10:] == pytest.approx(between[10:], abs=1e-7)
