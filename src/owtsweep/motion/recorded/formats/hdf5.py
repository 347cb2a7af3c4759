"""Read HDF5: arrays of MATLAB 7.3, and gtsdf (General Time Series Data Format) of HAWC2.

Each of the groups block0000, block0001, ... holds the table `data`, with one row per time step and
one column per channel, and the HDF5 attributes `time_step` and `time_start`. A group may also hold
the vectors `time` (0, 1, 2, ... if absent), `gains` (1 if absent) and `offsets` (0 if absent). The
time of a row is time_start + time_step * time, and the value of a channel is data * gain + offset.
In a table of integers, the largest value of the integer type means that a value is missing. The
root of the file holds `attribute_names` and `attribute_units`, one text per channel; time is not
among these channels. The documentation of DTU's Wind Energy Toolbox (wetb.gtsdf) defines the
format.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.motion.recorded.formats.arrays import Variable
from owtsweep.motion.recorded.formats.table import (
    MOST_VALUES,
    ChannelTable,
    refuse_damaged,
    require_channels,
)

if TYPE_CHECKING:
    import h5py

TIME = "Time"
#: What is said of a damaged file, and the errors that h5py raises on one.
DAMAGED = (
    "is not a whole HDF5 file", OSError, RuntimeError, KeyError, ValueError, TypeError,
    AttributeError, MemoryError,
)  # fmt: skip
#: Most bytes of a name or unit. An array whose texts may be longer is not read.
LONGEST_WORD = 1024


def open_gtsdf(path: Path) -> ChannelTable:
    """Open a gtsdf file (HDF5 as HAWC2 writes it) with the package h5py.

    Raises InputError without h5py, or if the file is not gtsdf, or holds links where data should
        be.
    """
    with _open(path) as file:
        blocks = sorted(name for name in file if name.startswith("block"))
        shapes = [_open_data(path, file, block).shape for block in blocks]
        require(bool(blocks), f"{path}: is HDF5 but not gtsdf (no block0000/data)")
        count = shapes[0][1]
        require(
            all(shape[1] == count for shape in shapes),
            f"{path}: is HDF5 but not gtsdf (its blocks differ in their channels)",
        )
        require_channels(path, count)
        names = _read_words(path, file, "attribute_names", count)
        units = _read_words(path, file, "attribute_units", count)
    names = [TIME, *(name or str(place) for place, name in enumerate(names, start=1))]
    read, rows = partial(_read, path, blocks), sum(shape[0] for shape in shapes)
    return ChannelTable(path, "gtsdf (HDF5)", names, ["s", *units], read, rows)


def list_arrays(path: Path) -> Iterator[Variable]:
    """Yield the variables of a file of MATLAB's version 7.3; read none of their numbers."""

    def load(name: str) -> Array:
        with _open(path) as file:
            return np.asarray(file[name][()], dtype=float).T  # MATLAB goes down the columns

    with _open(path) as file:
        require_channels(path, len(file))
        for name in file:
            if name.startswith("#"):  # what cells and objects refer to
                continue
            data: Any = _follow(path, file, name)
            real = hasattr(data, "dtype") and data.dtype.kind in "fiu"
            if real:
                kind = data.attrs.get("MATLAB_class")
                real = kind not in (b"char", "char") and "MATLAB_empty" not in data.attrs
            shape = data.shape[::-1] if real else ()
            yield Variable(name, shape, real, partial(load, name))


@contextmanager
def _open(path: Path) -> Iterator[h5py.File]:
    try:
        import h5py
    except ImportError:
        raise InputError(f"{path}: HDF5 needs h5py: pip install 'owtsweep[recorded]'") from None
    with refuse_damaged(path, *DAMAGED), h5py.File(path, "r") as file:
        yield file


def _open_data(path: Path, file: h5py.File, block: str) -> h5py.Dataset:
    import h5py

    group = _follow(path, file, block)
    data = _follow(path, group, "data") if isinstance(group, h5py.Group) else None
    if not isinstance(data, h5py.Dataset) or data.ndim != 2 or data.dtype.kind not in "fiub":
        raise InputError(f"{path}: is HDF5 but not gtsdf (no {block}/data)")
    return data


def _follow(path: Path, group: h5py.Group, name: str) -> h5py.Group | h5py.Dataset | None:
    """Return a member of a group, None if there is none; refuse links and too large chunks."""
    import h5py

    if name not in group:
        return None
    hard = isinstance(group.get(name, getlink=True), h5py.HardLink)
    item = group[name] if hard else None
    if item is None or (isinstance(item, h5py.Dataset) and (item.external or item.is_virtual)):
        what = "is a link, perhaps to another file; store the data in its place"
        raise InputError(f"{path}: {name} {what}")
    if isinstance(item, h5py.Dataset) and item.chunks is not None:
        size = int(np.prod(item.chunks, dtype=float)) * item.dtype.itemsize
        require(
            size <= MOST_VALUES * 8,
            f"{path}: {name} has chunks of {size / 1e9:.3g} GB; store it in smaller chunks",
        )
    return item


def _read_words(path: Path, file: h5py.File, key: str, count: int) -> list[str]:
    words = _follow(path, file, key)
    if words is None or words.shape != (count,) or words.dtype.itemsize > LONGEST_WORD:
        return [""] * count
    texts = (t.decode("utf-8", "replace") if isinstance(t, bytes) else str(t) for t in words[:])
    return [text.strip() for text in texts]


def _read_vector(path: Path, group: h5py.Group, name: str, default: Array) -> Array:
    vector, count = _follow(path, group, name), len(default)
    if vector is None:
        return default
    numbers = vector.ndim == 1 and len(vector) >= count and vector.dtype.kind in "fiub"
    require(numbers, f"{path}: {name} does not hold {count} numbers")
    return np.asarray(vector[:count], dtype=float)


def _read(path: Path, blocks: Sequence[str], places: Sequence[int], rows: int) -> list[Array]:
    parts: list[list[Array]] = [[] for _ in places]
    with _open(path) as file:
        for block in blocks:
            data = _open_data(path, file, block)
            group = file[block]
            steps = min(data.shape[0], rows)
            rows -= steps
            gains = _read_vector(path, group, "gains", np.ones(data.shape[1]))
            offsets = _read_vector(path, group, "offsets", np.zeros(data.shape[1]))
            for part, place in zip(parts, places, strict=True):
                if place == 0:
                    count = _read_vector(path, group, "time", np.arange(steps, dtype=float))
                    step = float(np.asarray(group.attrs.get("time_step", 1.0)).item())
                    start = float(np.asarray(group.attrs.get("time_start", 0.0)).item())
                    part.append(start + step * count)
                    continue
                packed = data[:steps, place - 1]
                values = packed * gains[place - 1]
                values += offsets[place - 1]
                if np.issubdtype(packed.dtype, np.integer):
                    values[packed == np.iinfo(packed.dtype).max] = np.nan
                part.append(values)
    return [np.concatenate(part) for part in parts]
