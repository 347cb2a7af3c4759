"""Text tables: delimiters, headers, units, missing values, what is refused."""

from __future__ import annotations

import gzip
import time
from pathlib import Path

import numpy as np
import pytest

from owtsweep.errors import InputError
from owtsweep.motion.recorded import describe, open_table, read
from owtsweep.motion.recorded.formats import streams, text
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
        ("time;x;y\n" + "0,1;1.5;2,5\n0,2;1,6;2,6\n", "line 2 on has numbers like 0,1 and 1.5"),
        ("time;x\n" + "1,000;2,500\n1,100;2,501\n", "is 1,000 from line 2 on 1000 or 1.000"),
        ("time,x\n" + "0,00,1,5\n0,05,1,6\n", "line 2 has 4 numbers below 2 names"),
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


@pytest.mark.parametrize("delimiter", [";", "\t", " ", ","])
@pytest.mark.parametrize("quoted", [False, True])
def test_decimal_commas_of_spreadsheets(tmp_path: Path, delimiter: str, quoted: bool) -> None:
    """Bit for bit the numbers of the same file with points."""
    if delimiter == "," and not quoted:
        pytest.skip("cannot be told apart")
    if delimiter == " " and quoted:
        pytest.skip("no program writes this")
    head = delimiter.join(["time", "x", "y"]) + "\n" + delimiter.join(["s", "m", "m"])
    points = table(delimiter, (head,), 17)
    commas = "\n".join(
        [head, *(delimiter.join(_with_comma(v, quoted) for v in row) for row in ROWS)]
    )
    first = f"sep={delimiter}\r\n" if delimiter == ";" else ""
    plain = read(write(tmp_path, points, "points.txt"))
    path = tmp_path / "commas.txt"
    path.write_bytes((first + commas.replace("\n", "\r\n") + "\r\n").encode())
    recording = read(path)
    assert recording.notes == plain.notes == ()  # units come from the line below the names
    np.testing.assert_array_equal(recording.time, plain.time)
    for role in ("position_x", "position_y"):
        np.testing.assert_array_equal(recording.channels[role], plain.channels[role])


def _with_comma(value: float, quoted: bool) -> str:
    text = f"{value:.17g}".replace(".", ",")
    return f'"{text}"' if quoted else text


def test_whole_numbers_first_and_decimal_commas_later(tmp_path: Path) -> None:
    rows = [f"{k};0;1" for k in range(50)] + [f"{k};0,25;1" for k in range(50, 99)]
    recording = read(write(tmp_path, "\n".join(["time;x;y", *rows])))
    assert recording.channels["position_x"][-1] == 0.25


def test_head_that_ends_inside_a_letter_is_still_utf_8(tmp_path: Path, monkeypatch) -> None:
    lines = ["time [s],x [m],yaw [°],site", *(f"{k},0,90,é" for k in range(40))]
    raw = "\n".join(lines).encode()
    monkeypatch.setattr(text, "HEAD", raw.rindex("é".encode()) + 1)
    (tmp_path / "r.csv").write_bytes(raw)
    assert open_table(tmp_path / "r.csv").units[2] == "°"


def test_text_in_utf_16_says_so(tmp_path: Path) -> None:
    path = tmp_path / "r.csv"
    path.write_bytes(table(head=("time,x,y",)).encode("utf-16"))
    with pytest.raises(InputError, match="save it as UTF-8"):
        read(path)


@pytest.mark.parametrize(
    "text",
    [
        "a\n" * (1 << 16),
        "time,x\n0," + "1" * 200_000 + "x\n" + "0,1\n" * 40,
        "time," + "_" * 200_000 + "\n" + "".join(f"{k},1\n" for k in range(40)),
    ],
)
def test_strange_text_is_read_in_no_time(tmp_path: Path, text: str) -> None:
    """These took minutes: the patterns of numbers and units tried every place to begin."""
    path = write(tmp_path, text)
    begin = time.perf_counter()
    with pytest.raises(InputError):
        read(path)
    assert time.perf_counter() - begin < 2.0


@pytest.mark.parametrize(
    ("name", "line", "said"),
    [
        ("r.csv.gz", b"0,0,0\n" * (1 << 16), "unpacks to more than"),
        ("r.csv.gz", b"\n" * (1 << 18), "unpacks to more than"),
        ("r.csv.gz", b"1" * (1 << 18), "a line of more than"),
        ("r.txt.gz", b"1 " * (1 << 17), "a line of more than"),
    ],
)
def test_bombs_are_put_out(tmp_path: Path, monkeypatch, name: str, line: bytes, said: str) -> None:
    monkeypatch.setattr(streams, "MOST_UNPACKED", 6_000_000 if "unpacks" in said else 20_000_000)
    between = " " if ".txt" in name else ","
    start = table(between, (between.join(("time", "x", "y")),)).encode()
    (tmp_path / name).write_bytes(gzip.compress(start + line * 32))
    with pytest.raises(InputError, match=said) as caught:
        read(tmp_path / name)
    assert str(caught.value).count(name) == 1


@pytest.mark.parametrize("name", ["r.csv", "r.txt"])
def test_more_rows_than_fit_are_refused(tmp_path: Path, monkeypatch, name: str) -> None:
    monkeypatch.setattr("owtsweep.motion.recorded.formats.table.MOST_VALUES", 300)
    between = "," if name == "r.csv" else " "
    path = write(tmp_path, table(between, (between.join("txy"),)), name)
    with pytest.raises(InputError, match="100 rows or more of 3 channels need"):
        read(path)


def test_damage_inside_a_compressed_file(tmp_path: Path) -> None:
    whole = bytearray(gzip.compress(table(head=("time,x,y",)).encode()))
    whole[1500:1503] = b"\xff\xff\xff"
    (tmp_path / "r.csv.gz").write_bytes(whole)
    with pytest.raises(InputError, match="cannot be read"):
        read(tmp_path / "r.csv.gz")


def test_names_can_be_printed(tmp_path: Path) -> None:
    wild = "x\x1b[31m\u202e" + "long" * 2000
    text = "\n".join([f"time,{wild},x,x", *(f"{k},1,2,3" for k in range(40))])
    opened = open_table(write(tmp_path, text))
    assert opened.names[0] == "time"
    assert opened.names[1].startswith(r"x\x1b[31m\u202elong")
    assert len(opened.names[1]) < 220
    assert all(name.isprintable() for name in opened.names)
    loaded = opened.load(opened.names, None)
    assert [loaded[name][0] for name in opened.names] == [0, 1, 2, 3]
    assert "x (2)" in describe(opened.path)
