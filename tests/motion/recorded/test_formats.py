"""Every format gives back what its documented layout was filled with; broken files are refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import writers

from owtsweep.errors import InputError
from owtsweep.motion.recorded import open_table, read
from owtsweep.motion.recorded.formats import hdf5

STEP = 0.05
TIME = STEP * np.arange(1, 401)
X = 0.4 + 0.3 * np.sin(2 * np.pi * 0.25 * TIME)
Y = -0.1 + 0.02 * np.cos(2 * np.pi * 0.3 * TIME)
FAST: writers.Table = {
    "Time": ("s", TIME),
    "RotSpeed": ("rpm", np.full(400, 12.1)),
    "TwHt1TPxi": ("m", X),
    "TwHt1TPyi": ("m", Y),
}
HAWC2: writers.Table = {
    "Time": ("s", TIME),
    "Omega": ("rad/s", np.full(400, 1.2)),
    "State pos x  coo: blade1": ("m", 50 + X),
    "State pos x  coo: global": ("m", X),
    "State pos y  coo: global": ("m", Y),
}


def make(folder: Path, kind: str) -> Path:
    if kind.startswith("outb"):
        return writers.fast_binary(folder / "record.outb", FAST, int(kind[-1]))
    if kind == "out":
        return writers.fast_text(folder / "record.out", FAST)
    if kind.startswith("hawc2"):
        return writers.hawc2(folder, HAWC2, kind.split()[1].upper())
    if kind.startswith("gtsdf"):
        pytest.importorskip("h5py")
        return writers.gtsdf(folder / "record.hdf5", HAWC2, packed="packed" in kind)
    if kind == "npz":
        np.savez(folder / "record.npz", time=TIME, position=np.column_stack([X, Y]))
        return folder / "record.npz"
    table = pa.table({"time": TIME, "position_x": X, "position_y": Y})
    pq.write_table(table, folder / "record.parquet", write_page_checksum=True)
    return folder / "record.parquet"


KINDS = [f"outb {kind}" for kind in (1, 2, 3, 4)]
KINDS += ["out", "hawc2 ascii", "hawc2 binary", "gtsdf", "gtsdf packed", "npz", "parquet"]


@pytest.mark.parametrize("kind", KINDS)
def test_each_format_gives_back_what_was_written(tmp_path: Path, kind: str) -> None:
    """Columns guessed, units from the file, values to half a step of what the format can hold."""
    recording = read(make(tmp_path, kind))
    packed = kind in ("outb 1", "outb 2", "outb 4", "hawc2 binary", "gtsdf packed")
    np.testing.assert_allclose(recording.time, TIME, rtol=1e-7 if "hawc2" not in kind else 1e-4)
    for role, truth in (("position_x", X), ("position_y", Y)):
        coarse = np.abs(truth).max() if kind == "hawc2 binary" else np.ptp(truth)
        error = 0.51 * coarse / 32000 if kind == "hawc2 binary" else 0.52 * coarse / 65534
        digits = 1e-5 if kind == "hawc2 ascii" else 1e-8
        np.testing.assert_allclose(
            recording.channels[role], truth, rtol=0, atol=error if packed else digits
        )
    assumed = any("units not in the file" in note for note in recording.notes)
    assert assumed == (kind in ("npz", "parquet"))


def test_either_file_of_hawc2_will_do_and_a_lone_one_is_refused(tmp_path: Path) -> None:
    sel = make(tmp_path, "hawc2 binary")
    by_dat = read(sel.with_suffix(".dat"))
    np.testing.assert_array_equal(by_dat.channels["position_x"], read(sel).channels["position_x"])
    sel.with_suffix(".dat").unlink()
    with pytest.raises(InputError, match=r"record\.dat is missing"):
        read(sel)


def test_time_of_hawc2_survives_its_16_bits(tmp_path: Path) -> None:
    """600 s at 100 Hz: the packed time repeats itself; the restored one is the comb."""
    time = 100.0 + 0.01 * np.arange(1, 60001)
    table = {"Time": ("s", time), "State pos x  coo: global": ("m", np.sin(time))}
    recording = read(writers.hawc2(tmp_path, table, "BINARY"))
    np.testing.assert_allclose(np.diff(recording.time), 0.01, rtol=1e-9)
    np.testing.assert_allclose(recording.time, time, atol=0.001)


def test_missing_values_of_gtsdf(tmp_path: Path) -> None:
    pytest.importorskip("h5py")
    holes = X.copy()
    holes[::7] = np.nan
    table = {"Time": ("s", TIME), "fix_x": ("m", holes), "State pos x  coo: global": ("m", X)}
    recording = read(writers.gtsdf(tmp_path / "r.hdf5", table, packed=True))
    np.testing.assert_array_equal(np.isnan(recording.channels["fix_x"]), np.isnan(holes))


def test_without_h5py_one_line_says_what_to_install(tmp_path: Path, monkeypatch) -> None:
    import sys

    path = make(tmp_path, "gtsdf")
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(InputError, match=r"owtsweep\[recorded\]"):
        hdf5.open_gtsdf(path)


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in ("out", "hawc2 ascii")])
@pytest.mark.parametrize("kept", [0.0, 0.01, 0.3, 0.9, 0.999])
def test_files_cut_short_are_refused_in_one_line(tmp_path: Path, kind: str, kept: float) -> None:
    path = make(tmp_path, kind)
    if kind.startswith("hawc2"):
        path = path.with_suffix(".dat")
    raw = path.read_bytes()
    path.write_bytes(raw[: int(kept * len(raw))])
    with pytest.raises(InputError) as caught:
        read(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "name",
    ["r.outb", "r.hdf5", "r.npz", "r.mat", "r.parquet", "r.csv", "r.out", "r.dat", "r.csv.gz"],
)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_noise_is_no_file_of_any_format(tmp_path: Path, name: str, seed: int) -> None:
    path = tmp_path / name
    path.write_bytes(b"\2\0" * (seed == 3) + np.random.default_rng(seed).bytes(4000))
    with pytest.raises(InputError) as caught:
        read(path)
    assert "\n" not in str(caught.value)


def test_pickled_archives_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "r.npz"
    np.savez(path, time=TIME, x=np.array([{"a": 1}], dtype=object))
    with pytest.raises(InputError, match="pickled"):
        read(path)
    path.write_bytes(path.read_bytes()[:300])  # np.load would call this a pickle too
    with pytest.raises(InputError, match=r"not a whole \.npz archive"):
        read(path)


def test_parquet_timestamps_and_units_of_fields(tmp_path: Path) -> None:
    stamps = pa.array(np.rint(TIME * 1e9).astype("int64")).cast(pa.timestamp("ns"))
    schema = pa.schema(
        [
            pa.field("time", pa.timestamp("ns")),
            pa.field("x", pa.float64(), metadata={"unit": "mm"}),
        ]
    )
    pq.write_table(pa.table([stamps, pa.array(1000 * X)], schema=schema), tmp_path / "r.parquet")
    recording = read(tmp_path / "r.parquet")
    np.testing.assert_allclose(recording.time, TIME - TIME[0], atol=1e-9)
    np.testing.assert_allclose(recording.channels["position_x"], X)


@pytest.mark.parametrize("name", ["r.xlsx", "r", "r.outb.gz"])
def test_unknown_extensions_list_the_known_ones(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"something")
    with pytest.raises(InputError, match=r"\.csv"):
        open_table(tmp_path / name)


def test_no_file_and_a_folder(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        open_table(tmp_path / "absent.csv")
    with pytest.raises(InputError, match="a folder"):
        open_table(tmp_path)
