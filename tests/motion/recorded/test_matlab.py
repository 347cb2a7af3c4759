"""MATLAB files: what becomes a channel, what is left out unread, what is refused."""

from __future__ import annotations

import struct
import tracemalloc
import zlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.motion.recorded import describe, open_table, read
from owtsweep.motion.recorded.formats.matlab import OLD, TYPES

TIME = 0.1 * np.arange(400)
X = np.sin(TIME)


def refusal(path: Path, *names: str) -> str:
    with pytest.raises(InputError) as caught:
        load(path, *names)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def load(path: Path, *names: str) -> Mapping[str, Array]:
    table = open_table(path)
    return table.load(names or table.names, None)


def save(folder: Path, **variables: object) -> Path:
    savemat(folder / "r.mat", variables)
    return folder / "r.mat"


def test_vectors_and_matrices_become_channels(tmp_path: Path) -> None:
    tall = np.random.default_rng(1).normal(size=(400, 5))
    path = save(tmp_path, time=TIME[:, None], v=X[None, :], tall=tall, wide=tall.T[:2],
                small=np.arange(400, dtype=np.uint8), short=X[:7], fs=10.0)  # fmt: skip
    table = open_table(path)
    wide = ("wide_x", "wide_y")
    assert set(table.names) == {
        "time", "v", *(f"tall_{i}" for i in range(1, 6)), *wide, "small", "short",
    }  # fmt: skip
    loaded = table.load(("time", "v", "tall_5", *wide, "small"), None)
    assert np.array_equal(loaded["time"], TIME)
    assert np.array_equal(loaded["v"], X)
    assert np.array_equal(loaded["tall_5"], tall[:, 4])
    assert np.array_equal(loaded["wide_y"], tall[:, 1])
    assert np.array_equal(loaded["small"], np.arange(400) % 256)
    assert len(table.load(("v",), 10)["v"]) == 10
    said = refusal(path, "time", "short")
    assert "channels differ in length (time 400, short 7)" in said
    assert "short   no unit, 0 to 0.5" in describe(path)


def test_the_room_for_recorded_motion_reads_them(tmp_path: Path) -> None:
    recording = read(save(tmp_path, time=TIME, position=np.column_stack([X, -X])))
    assert np.allclose(recording.channels["position_y"], -X)


def test_nothing_but_numbers_is_loaded(tmp_path: Path) -> None:
    cell = np.array([1, "a"], dtype=object)
    path = save(tmp_path, time=TIME, s={"x": X}, c=cell, text="hello", z=X * 1j)
    table = open_table(path)
    assert table.names == ("time",)
    assert table.notes == ["no arrays of real numbers, left out: s, c, text, z"]
    said = refusal(save(tmp_path, s={"x": X}, c=cell))
    assert "has no array of numbers: save plain vectors (no arrays of real numbers, left" in said


HEADERS = [b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512), b""]


@pytest.mark.parametrize("header", HEADERS)
def test_a_damaged_file_of_version_7_3_is_refused(tmp_path: Path, header: bytes) -> None:
    path = tmp_path / "r.mat"
    path.write_bytes(header + b"\x89HDF\r\n\x1a\n" + bytes(1000))
    assert "is not a whole HDF5 file" in refusal(path)


@pytest.mark.parametrize("header", HEADERS)
def test_version_7_3_is_read_as_version_7_is(tmp_path: Path, header: bytes) -> None:
    h5py = pytest.importorskip("h5py")
    path, tall = tmp_path / "r.mat", np.random.default_rng(1).normal(size=(400, 2))
    with h5py.File(path, "w", userblock_size=len(header)) as file:
        for name, values, kind in [
            ("time", TIME[:, None], "double"), ("tall", tall, "double"), ("v", X[None], "single"),
            ("text", np.full((1, 5), 65, np.uint16), "char"), ("fs", np.ones((1, 1)), "double"),
        ]:  # fmt: skip
            file.create_dataset(name, data=values.T).attrs["MATLAB_class"] = np.bytes_(kind)
        file.create_dataset("z", data=np.zeros((1, 400), [("real", "f8"), ("imag", "f8")]))
        file.create_group("s").attrs["MATLAB_class"] = np.bytes_("struct")
        file.create_group("#refs#")
    with path.open("r+b") as raw:
        raw.write(header)
    table = open_table(path)
    assert set(table.names) == {"time", "tall_x", "tall_y", "v"}
    assert table.notes == ["no arrays of real numbers, left out: fs, s, text, z"]
    loaded = table.load(table.names, 300)
    assert np.array_equal(loaded["tall_y"], tall[:300, 1])
    assert np.array_equal(loaded["v"], X[:300])


def test_both_byte_orders_and_all_types_of_numbers(tmp_path: Path) -> None:
    """Written by hand as MATLAB's format says; SciPy writes little-endian files of doubles."""
    path = tmp_path / "r.mat"
    for order, mark in (("<", b"IM"), (">", b"MI")):
        for code, kind in TYPES.items():
            values = np.array([1, 2, 3, 4, 5], dtype=order + kind)
            body = struct.pack(order + "4I", 6, 8, 6, 0)  # flags: class double, stored as `kind`
            body += struct.pack(order + "4I", 5, 8, 1, 5)  # shape
            body += struct.pack(order + "2I", 2 << 16 | 1, 0)[:4] + b"xy\0\0"  # a short name
            raw = values.tobytes()
            body += struct.pack(order + "2I", code, len(raw)) + raw + bytes(-len(raw) % 8)
            header = b"MATLAB 5.0".ljust(124) + struct.pack(order + "H", 0x0100) + mark
            path.write_bytes(header + struct.pack(order + "2I", 14, len(body)) + body)
            assert np.array_equal(load(path)["xy"], [1, 2, 3, 4, 5])
        for precision, kind in OLD.items():
            head = struct.pack(order + "5i", 1000 * (order == ">") + 10 * precision, 5, 1, 0, 2)
            path.write_bytes(head + b"x\0" + np.arange(5, dtype=order + kind).tobytes())
            assert np.array_equal(load(path)["x"], np.arange(5))


@pytest.mark.parametrize(("version", "packed"), [("4", False), ("5", False), ("5", True)])
def test_damaged_files_are_refused_or_read(tmp_path: Path, version: str, packed: bool) -> None:
    """Cut anywhere, or with bytes changed: one line, or numbers; never another error."""
    rng = np.random.default_rng(3)
    path = tmp_path / "r.mat"
    savemat(path, {"time": TIME, "m": X[:, None] * np.ones(6), "n": X[:1]}, format=version,
            do_compression=packed)  # fmt: skip
    whole = path.read_bytes()
    told = []
    for number in range(300):
        raw = bytearray(whole[: rng.integers(1, len(whole))] if number % 2 else whole)
        for place in rng.integers(0, min(len(raw), 400), 3):
            raw[place] = rng.integers(256)
        path.write_bytes(raw)
        try:
            load(path)
        except InputError as error:
            told.append(str(error))
    assert len(told) > 150
    assert not any("\n" in each for each in told)


def test_a_small_file_cannot_unpack_to_a_large_one(tmp_path: Path) -> None:
    path = save(tmp_path, time=TIME)
    bomb = zlib.compress(struct.pack("<2I", 14, 48) + bytes(20_000_000))
    path.write_bytes(path.read_bytes()[:128] + struct.pack("<2I", 15, len(bomb)) + bomb)
    tracemalloc.start()
    assert "no array of numbers" in refusal(path) or "not a whole" in refusal(path)
    assert tracemalloc.get_traced_memory()[1] < 5e6
    tracemalloc.stop()
