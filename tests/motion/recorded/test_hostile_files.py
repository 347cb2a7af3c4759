"""Files that lie about their size, name other files, or are no files; times that need too much."""

from __future__ import annotations

import os
import struct
import zipfile
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import writers

from owtsweep.errors import InputError
from owtsweep.motion.recorded import describe, open_table, read, to_motion
from owtsweep.motion.recorded.formats import table

TIME = np.arange(400) / 20.0
X = 0.3 * np.sin(TIME)


def refusal(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        read(path)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("ending", ["csv", "csv.gz", "outb", "npz", "parquet", "h5", "sel"])
def test_pipes_and_devices_are_no_records(tmp_path: Path, ending: str) -> None:
    os.mkfifo(tmp_path / f"pipe.{ending}")
    (tmp_path / f"zero.{ending}").symlink_to("/dev/zero")
    for name in ("pipe", "zero"):
        assert "a pipe or a device" in refusal(tmp_path / f"{name}.{ending}")


def test_companion_that_is_a_pipe(tmp_path: Path) -> None:
    sel = writers.hawc2(tmp_path, {"Time": ("s", TIME), "x": ("m", X)}, "BINARY")
    sel.unlink()
    os.mkfifo(sel)
    assert "a pipe or a device" in refusal(sel.with_suffix(".dat"))


def test_a_selection_that_announces_more_than_there_can_be(tmp_path: Path) -> None:
    sel = writers.hawc2(tmp_path, {"Time": ("s", TIME), "x": ("m", X)}, "BINARY")
    lines = sel.read_text().splitlines()
    lines[8] = lines[8].replace(str(len(TIME)), str(10**19), 1)
    sel.write_text("\n".join(lines))
    with pytest.raises(InputError, match="is cut short") as caught:
        read(sel, rows=10)
    assert "\n" not in str(caught.value)


def test_an_archive_of_no_rows_says_so(tmp_path: Path) -> None:
    np.savez(tmp_path / "r.npz", time=np.zeros(0), position_x=np.zeros(0))
    assert "has 0 rows" in refusal(tmp_path / "r.npz")


def lying_npz(path: Path, shape: str, descr: str = "<f8") -> Path:
    header = f"{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name in ("time", "x"):
            length = struct.pack("<H", len(header))
            archive.writestr(f"{name}.npy", b"\x93NUMPY\1\0" + length + header + X.tobytes())
    return path


@pytest.mark.parametrize(
    ("shape", "said"),
    [
        (f"({10**12},)", "is to hold 8000000000000 bytes"),
        (f"({10**30},)", "is to hold"),
        (f"(0, {10**12})", "channels; at most"),
        (f"({10**12}, 0)", "no array of numbers"),
        ("(-5,)", "not a whole .npz"),
    ],
)
def test_archives_that_lie_about_their_size(tmp_path: Path, shape: str, said: str) -> None:
    assert said in refusal(lying_npz(tmp_path / "r.npz", shape))


def test_archive_of_large_records_of_no_numbers(tmp_path: Path) -> None:
    assert "no array" in refusal(lying_npz(tmp_path / "r.npz", "(100,)", "|V1000000000"))


def test_what_a_file_announces_is_compared_with_what_fits(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(table, "MOST_VALUES", 700)
    pq.write_table(pa.table({"time": TIME, "x": X}), tmp_path / "r.parquet")
    fast = {"Time": ("s", TIME), "x": ("m", X)}
    writers.fast_binary(tmp_path / "r.outb", fast, 2)
    writers.hawc2(tmp_path, fast, "BINARY")
    for name in ("r.parquet", "r.outb", "record.sel"):
        assert "400 rows of 2 channels need 6.4e-06 GB" in refusal(tmp_path / name)


def test_large_parquet_file_is_described_from_its_beginning(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr("owtsweep.motion.recorded.describing.MOST_ROWS", 100)
    text = pa.DictionaryArray.from_arrays(pa.array(np.zeros(400, np.int32)), ["a" * 1_000_000])
    pq.write_table(
        pa.table({"time": TIME, "x": X, "s": text}), tmp_path / "r.parquet", store_schema=False
    )
    text = describe(tmp_path / "r.parquet")
    assert "3 channels, 100 rows looked at, the first of more" in text
    assert text.endswith("The rest:\n  s")


def test_repeated_names_of_parquet(tmp_path: Path) -> None:
    columns = [pa.array(TIME), pa.array(X), pa.array(2 * X)]
    pq.write_table(pa.Table.from_arrays(columns, names=["time", "x", "x"]), tmp_path / "r.parquet")
    loaded = open_table(tmp_path / "r.parquet").load(["x", "x (2)"], None)
    np.testing.assert_array_equal(2 * loaded["x"], loaded["x (2)"])


def hdf5(path: Path, fill) -> Path:
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        fill(h5py, file, file.create_group("block0000"))
    return path


HDF5 = {
    "zeros": lambda h, f, g: g.create_dataset("data", (10**12, 1), "f8", chunks=(1000, 1)),
    "channels": lambda h, f, g: g.create_dataset("data", (9, 10**9), "f4", chunks=(9, 9)),
    "chunk": lambda h, f, g: g.create_dataset("data", (60000, 8000), "f8", chunks=(60000, 8000)),
    "device": lambda h, f, g: g.create_dataset(
        "data", (400, 2), "f8", external=[("/dev/zero", 0, h.h5f.UNLIMITED)]
    ),
    "other": lambda h, f, g: g.__setitem__("data", h.ExternalLink("other.h5", "/data")),
    "loop": lambda h, f, g: g.__setitem__("data", h.SoftLink("/block0000/data")),
    "vector": lambda h, f, g: g.create_dataset("data", data=X),
    "text": lambda h, f, g: g.create_dataset("data", data=np.array([[b"a", b"b"]] * 40)),
    "group": lambda h, f, g: g.create_group("data"),
    "gains": lambda h, f, g: (
        g.create_dataset("data", data=np.ones((400, 1))),
        g.create_dataset("gains", (0,), "f8"),
    ),
}


@pytest.mark.parametrize(
    ("kind", "said"),
    [
        ("zeros", "1000000000000 rows of 2 channels need 1.6e+04 GB"),
        ("channels", "1000000000 channels"),
        ("chunk", "chunks of 3.84 GB"),
        ("device", "a link, perhaps to another file"),
        ("other", "a link, perhaps to another file"),
        ("loop", "a link"),
        ("vector", "not gtsdf"),
        ("text", "not gtsdf"),
        ("group", "not gtsdf"),
        ("gains", "gains does not hold 1 numbers"),
    ],
)
def test_hdf5_that_asks_for_too_much(tmp_path: Path, kind: str, said: str) -> None:
    path = hdf5(tmp_path / "r.h5", HDF5[kind])
    with pytest.raises(InputError, match=said.replace("+", r"\+")):
        read(path, columns={"position_x": "1"})


def test_names_of_hdf5_that_are_too_many(tmp_path: Path) -> None:
    def fill(h5py, file, group) -> None:
        group.create_dataset("data", data=np.ones((400, 1)))
        file.create_dataset("attribute_names", (10**10,), "S100", chunks=(1000,))

    assert open_table(hdf5(tmp_path / "r.h5", fill)).names == ("Time", "1")


def csv(path: Path, time: np.ndarray, x: np.ndarray = X) -> Path:
    rows = (f"{t!r},{v!r}" for t, v in zip(time.tolist(), x.tolist(), strict=True))
    path.write_text("time,x\n" + "\n".join(rows) + "\n")
    return path


def test_steps_that_no_memory_holds(tmp_path: Path) -> None:
    slow = read(csv(tmp_path / "r.csv", 1e6 * np.arange(400.0)))
    with pytest.raises(InputError, match=r"at 100 Hz are 3.99e\+10 steps, 6.38e\+03 GB"):
        to_motion(slow, 100.0)
    with pytest.raises(InputError, match="at most 50000000 are run"):
        to_motion(read(csv(tmp_path / "r.csv", TIME)), 1e9)


@pytest.mark.parametrize("step", [1.0, 1e-320])
def test_times_that_jump(tmp_path: Path, step: float) -> None:
    time = step * np.arange(400.0)
    time[200:] += 1e12 * np.arange(1, 201)
    time[399] = 1e300
    time[:399] = np.sort(time[:399])
    path = csv(tmp_path / "r.csv", np.r_[step * np.arange(399.0), 1e300])
    with pytest.raises(InputError, match="does the time jump"):
        read(path, gaps="interpolate")
    assert "spans" in describe(path)


def test_numbers_that_cannot_be(tmp_path: Path) -> None:
    assert "check units.position_x" in refusal(csv(tmp_path / "r.csv", TIME, 0 * X + 1e308))


def test_one_bad_column_among_thousands_is_found_in_few_reads(tmp_path: Path) -> None:
    names = ",".join(f"c{k}" for k in range(2000))
    row = ",".join(["1"] * 1999)
    (tmp_path / "r.csv").write_text(f"{names}\n" + f"{row},oops\n" * 40)
    opened = open_table(tmp_path / "r.csv")
    reads: list[int] = []

    def read(places, rows):
        reads.append(len(places))
        return opened.read(places, rows)

    from dataclasses import replace

    from owtsweep.motion.recorded.describing import _load

    loaded = _load(replace(opened, read=read), opened.names, 100)
    assert len(loaded) == 1999
    assert len(reads) < 40
