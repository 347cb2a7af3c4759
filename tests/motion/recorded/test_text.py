"""Text tables: delimiters, headers, units, missing values, what is refused."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest

from owtsweep.errors import InputError
from owtsweep.motion.recorded import read
from owtsweep.motion.recorded.formats.text import open_text

TIME = np.arange(200) / 20.0
X = np.sin(TIME)
Y = 0.5 * np.cos(TIME)
ROWS = list(zip(TIME, X, Y, strict=True))


def table(delimiter: str = ",", head: tuple[str, ...] = (), precision: int = 9) -> str:
    rows = [delimiter.join(f"{v:.{precision}g}" for v in row) for row in ROWS]
    return "\n".join([*head, *rows]) + "\n"


def write(folder: Path, text: str, name: str = "record.csv") -> Path:
    path = folder / name
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("delimiter", "head"),
    [
        (",", ("time,position_x,position_y",)),
        (";", ("Time [s];position_x [m];position_y [m]",)),
        ("\t", ("Time\tx\ty", "(s)\t(m)\t(m)")),
        ("   ", ("  t  x  y",)),
        (",", ("# a note, with a comma", "", "# time, x (m), y (m)")),
        (
            "\t",
            ("Made by FAST on 12-Nov-2026", "", "Time    \t x   \t y ", "(s)\t(m)\t(m)"),
        ),
    ],
)
def test_layouts(tmp_path: Path, delimiter: str, head: tuple[str, ...]) -> None:
    recording = read(write(tmp_path, table(delimiter, head), "record.txt"))
    np.testing.assert_allclose(recording.time, TIME, rtol=1e-8)
    np.testing.assert_allclose(recording.channels["position_x"], X, rtol=1e-8)
    np.testing.assert_allclose(recording.channels["position_y"], Y, rtol=1e-8)
    stated = "[" in head[-1] or "(" in head[-1]
    assert any("taken as SI" in note for note in recording.notes) != (stated and "#" not in head[0])


def test_compressed(tmp_path: Path) -> None:
    path = tmp_path / "record.csv.gz"
    path.write_bytes(gzip.compress(table(head=("time,x,y",)).encode()))
    np.testing.assert_allclose(read(path).channels["position_y"], Y, rtol=1e-8)


def test_line_ends_of_windows(tmp_path: Path) -> None:
    path = tmp_path / "record.csv"
    path.write_bytes(table(head=("a preamble", "", "time,x,y")).replace("\n", "\r\n").encode())
    np.testing.assert_allclose(read(path).channels["position_y"], Y, rtol=1e-8)


def test_missing_values_and_text_columns(tmp_path: Path) -> None:
    lines = ["time,x,status,y"]
    lines += [
        f"{t},{x},ok,{'' if k % 4 else 1.5}" for k, (t, x) in enumerate(zip(TIME, X, strict=True))
    ]
    opened = open_text(write(tmp_path, "\n".join(lines)))
    loaded = opened.load(["y", "x"], None)
    assert np.isfinite(loaded["y"]).sum() == 50
    np.testing.assert_allclose(loaded["x"], X)


def test_without_header_the_columns_are_numbered(tmp_path: Path) -> None:
    recording = read(
        write(tmp_path, table()), columns={"time": "1", "position_x": "2", "position_y": "3"}
    )
    np.testing.assert_allclose(recording.channels["position_x"], X, rtol=1e-8)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "is empty"),
        ("  \n\n", "is empty"),
        ("time;x;y\n" + "0,1;1,5;2,5\n0,2;1,6;2,6\n", "line 2 has decimal commas"),
        ("a letter\nto nobody\n", "no table of numbers"),
        ("time,x\n0,1\n", "rows"),
        ("time,x,y\n" + "\n".join(f"{k},1,2" for k in range(50)) + "\n50,oops,2\n", "numbers"),
        ("time,x,y\n" + "\n".join(f"{k},1,2" for k in range(50)) + "\n50,2\n", "numbers"),
    ],
)
def test_refusals_name_the_file_in_one_line(tmp_path: Path, text: str, said: str) -> None:
    path = write(tmp_path, text)
    with pytest.raises(InputError, match=said) as caught:
        read(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_truncated_gzip_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "record.csv.gz"
    whole = gzip.compress(table(head=("time,x,y",)).encode())
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(InputError, match="cannot be read"):
        read(path)
