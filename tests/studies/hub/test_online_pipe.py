"""examples/online_from_pipe.py: samples in, estimates out, line by line."""

from __future__ import annotations

import io
import os
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from tools import configure, measured

import owtsweep

SCRIPT = Path(__file__).parents[3] / "examples" / "online_from_pipe.py"
SENSORS = ["sensors.imu.rate=20", "sensors.gnss.rate=2", "hme.mhe.interval=0.1", "tuning=paper"]


def lines() -> list[str]:
    """10 s of samples at 20 Hz, a fix every .5 s but for a gap of 2 s."""
    data, known = measured(configure("record.duration=10", "sensors.yaw=0"))
    made = ["time,fx,fy,x,y"]
    for k, force in enumerate(data.specific_force):
        line = f"{k * known.step:.3f},{force[0]!s},{force[1]!s}"
        if k % known.fix_interval == 0 and not 80 <= k < 120:
            x, y = data.fixes[k // known.fix_interval]
            line += f",{x!s},{y!s}"
        made.append(line if k % 3 else line + ",," if line.count(",") == 2 else line)
    return made


def script(*arguments: str, text: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, str(SCRIPT), *arguments],
        input=text, capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip


@pytest.mark.usefixtures("kernels")
def test_a_byte_order_mark_before_the_first_number_does_not_matter() -> None:
    samples = "0.00,0.1,0.2,1,2\n0.05,0.1,0.2\n"
    marked, plain = (script("HME1", *SENSORS, text=text) for text in (f"\ufeff{samples}", samples))
    assert (marked.returncode, marked.stderr) == (0, "")
    assert marked.stdout == plain.stdout


@pytest.mark.usefixtures("kernels")
def test_it_writes_what_the_estimator_gives() -> None:
    made = lines()
    done = script("HME2", *SENSORS, text="\n".join(made) + "\n")
    assert (done.returncode, done.stderr) == (0, "")
    rows = done.stdout.splitlines()
    assert rows[0] == "time,x,y,vx,vy,sd_x,sd_y,sd_vx,sd_vy"
    found = np.array([[float(item) for item in row.split(",")] for row in rows[1:]])
    estimator = owtsweep.online("HME2", SENSORS)
    assert len(found) == len(made) - 1
    for row, line in zip(found, made[1:], strict=True):
        values = [float(item) for item in line.split(",") if item]
        estimate = estimator.update(values[1:3], values[3:] or None)
        expected = [values[0], *estimate.position, *estimate.velocity]
        expected += list(np.sqrt(np.diagonal(estimate.covariance)))
        np.testing.assert_allclose(row, expected, rtol=1e-5, atol=1e-12)


@pytest.mark.usefixtures("kernels")
def test_map_coordinates_headers_and_dates(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Millimetres at 6 million metres, a header in quotes, dates that come back as they came."""
    made = ['"Time","fx","fy","x","y"', "2026-03-01T12:00:59.90Z,0.1,0"]
    made += [f"2026-03-01T12:00:59.95Z,0.1,0,{6123456.789},{512345.678}"]
    made += ["# a comment", "TIME,fx,fy", "2026-03-01T12:01:00.00Z,0.1,0"]
    rows = run_here(["MKF", *SENSORS], made, capsys, monkeypatch)
    assert [row.split(",")[0] for row in rows] == [made[k].split(",")[0] for k in (1, 2, 5)]
    assert rows[0].split(",")[1:] == ["nan"] * 4 + ["inf"] * 4
    assert rows[1].split(",")[1:3] == ["6123456.789", "512345.678"]
    start = ["origin=6123456,512345", "mkf.p0=[1,1,1,1]"]
    stated = run_here(["MKF", *start, *SENSORS], made, capsys, monkeypatch)
    found = [float(item) for item in stated[1].split(",")[1:3]]
    assert stated[0].split(",")[1].startswith("6123456.000")
    # the start, uncertain by 1 m, and the first fix
    assert 6123456.6 < found[0] < 6123456.789
    assert len(stated[1].split(",")[1]) == len("6123456.73425")


def run_here(
    words: list[str],
    made: list[str],
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> list[str]:
    """Run the program in this process; return the rows that it wrote below its header."""
    monkeypatch.setattr(sys, "stdin", io.StringIO("\n".join(made) + "\n"))
    assert runpy.run_path(str(SCRIPT))["main"](words) == 0
    output = capsys.readouterr()
    assert output.err == ""
    return output.out.splitlines()[1:]


def test_each_estimate_comes_before_the_next_sample() -> None:
    with subprocess.Popen(
        [sys.executable, str(SCRIPT), "MKF", *SENSORS],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    ) as process:  # fmt: skip
        assert process.stdin is not None
        assert process.stdout is not None
        assert process.stdout.readline().startswith("time,")
        for k in range(3):
            process.stdin.write(f"{0.05 * k},0.1,0.2,1,2\n")
            process.stdin.flush()
            assert process.stdout.readline().startswith(f"{0.05 * k},")
        process.stdin.close()
        assert process.wait(timeout=60) == 0


@pytest.mark.parametrize(("text", "message"), [
    ("0,0,0\n0.05,0\n", "line 2: 2 fields; give time,fx,fy or time,fx,fy,x,y"),
    ("0,0,0\n\n0.05,0,east\n", "line 3: 'east' is not a number"),
    ("0,nan,0\n", "line 1: 'nan' is not finite"),
    ("0,0,0\n12:61,0,0\n", "line 2: '12:61' is no date and time of ISO 8601"),
    ("0,0,0\n0.2,0,0\n", "line 2: time: 0.2 s is not one IMU step of 0.05 s after 0 s"),
    ("0,0,0,1,1\n0.05,0,0,1,1\n", "line 2: position: a fix came at step 1, but HME2 takes fixes "),
])  # fmt: skip
def test_a_bad_line_is_named(
    text: str, message: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    main = runpy.run_path(str(SCRIPT))["main"]
    monkeypatch.setattr(sys, "stdin", io.StringIO(text))
    assert main(["HME2", *SENSORS]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"online_from_pipe: {message}")
    assert error.count("\n") == 1


def test_a_byte_that_is_no_text_is_named() -> None:
    done = subprocess.run(
        [sys.executable, SCRIPT, "MKF", *SENSORS],
        input=b"0,0,0\n0.05,\xff,0\n", capture_output=True, check=False,
        env={**os.environ, "PYTHONUTF8": "1"},
    )  # fmt: skip
    assert done.returncode == 2
    told = done.stderr.decode().splitlines()[-1]
    assert told.startswith("online_from_pipe: line 2: '")
    assert told.endswith("is not a number")


def test_the_switching_scheme_runs_on_board(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    main = runpy.run_path(str(SCRIPT))["main"]
    monkeypatch.setattr(sys, "stdin", io.StringIO("0,0,0,1,1\n0.05,0,0\n"))
    assert main(["SWITCH", *SENSORS]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 3


def test_a_bad_override_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert runpy.run_path(str(SCRIPT))["main"](["HME3"]) == 2
    assert "there is no scheme 'HME3'" in capsys.readouterr().err
    assert runpy.run_path(str(SCRIPT))["main"](["MKF", "origin=1"]) == 2
    assert "origin: ['1'] is not two finite numbers; give x and y" in capsys.readouterr().err
