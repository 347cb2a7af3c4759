"""Read NumPy archives (.npz, without pickled objects) and Parquet files."""

from __future__ import annotations

import math
import tokenize
import zipfile
import zlib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.motion.recorded.formats.table import (
    ChannelTable,
    refuse_damaged,
    require_channels,
    require_room,
)

if TYPE_CHECKING:
    from pyarrow import parquet

T = TypeVar("T")
AXES = "xyz"
#: What is said of a damaged archive, and the errors that NumPy raises on one.
DAMAGED = (
    "is not a whole .npz archive", zipfile.BadZipFile, zlib.error, OSError, EOFError, ValueError,
    RuntimeError, TypeError, KeyError, OverflowError, tokenize.TokenError,
)  # fmt: skip
#: Version of a .npy header -> its reader. Version 3 is for named fields, which are no channels.
HEADERS = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}


def open_npz(path: Path) -> ChannelTable:
    """Open a NumPy archive of arrays that all have the same number n of rows.

    An array `a` of shape (n,) becomes the channel a; one of shape (n, 1) to (n, 3) the channels
    a_x, a_y, a_z; one with more columns a_1, a_2, ... What holds no numbers is left out.

    Raises InputError if the archive is damaged, holds pickled objects, or has no arrays of one
        length.
    """
    places: dict[str, tuple[str, int]] = {}  # channel -> member, column
    lengths: set[int] = set()
    with refuse_damaged(path, *DAMAGED), zipfile.ZipFile(path) as archive:
        for member in archive.infolist():
            shape = _find_shape(path, archive, member)
            if shape is None:
                continue
            lengths.add(shape[0])
            key = member.filename.removesuffix(".npy")
            channels = name_columns(path, key, shape[1]) if len(shape) == 2 else [key]
            places.update({each: (member.filename, n) for n, each in enumerate(channels)})
    require(bool(places), f"{path}: has no array of numbers")
    listed = ", ".join(map(str, sorted(lengths)[:5]))
    require(len(lengths) == 1, f"{path}: has arrays of different lengths ({listed})")
    names, found = tuple(places), list(places.values())

    def load(member: str) -> Array:
        with (
            refuse_damaged(path, *DAMAGED),
            zipfile.ZipFile(path) as archive,
            archive.open(member) as stream,
        ):
            array = np.lib.format.read_array(stream, allow_pickle=False)
        return array if array.ndim == 2 else array[:, None]

    def read(wanted: Sequence[int], rows: int) -> list[Array]:
        return pick_columns([found[place] for place in wanted], load, rows)

    return ChannelTable(path, "NumPy archive", names, ("",) * len(names), read, lengths.pop())


def pick_columns(
    wanted: Sequence[tuple[T, int]], load: Callable[[T], Array], rows: int
) -> list[Array]:
    """Return the first `rows` values of columns, each given as an array and its place in it.

    `load` reads an array, shape (n, columns); no array is read twice, and one at a time.
    """
    found: dict[tuple[T, int], Array] = {}
    for name in dict.fromkeys(name for name, _ in wanted):
        table = load(name)
        for each in wanted:
            if each[0] == name:
                found[each] = np.array(table[:rows, each[1]], dtype=float)
    return [found[each] for each in wanted]


def name_columns(path: Path, key: str, count: int) -> list[str]:
    """Return the channels that the columns of an array become, at most `MOST_CHANNELS`."""
    require_channels(path, count)
    return [f"{key}_{AXES[i] if count <= len(AXES) else i + 1}" for i in range(count)]


def _find_shape(
    path: Path, archive: zipfile.ZipFile, member: zipfile.ZipInfo
) -> tuple[int, ...] | None:
    """Return the shape that an array's header announces; None if the array is left out."""
    with archive.open(member) as stream:
        read_header = HEADERS.get(np.lib.format.read_magic(stream))
        if read_header is None:
            return None
        shape, _, dtype = read_header(stream)
        plain = "which can run code: save plain arrays"
        require(not dtype.hasobject, f"{path}: holds pickled objects, {plain}")
        if dtype.kind not in "fiub" or len(shape) not in (1, 2):
            return None
        size = math.prod(shape) * dtype.itemsize
        name, there = member.filename, member.file_size
        require(
            stream.tell() + size <= there,
            f"{path}: {name} is to hold {size} bytes of numbers, but holds {there}",
        )
        require_room(path, shape[0], math.prod(shape[1:]), shape[0])
        return tuple(shape)


def open_parquet(path: Path) -> ChannelTable:
    """Open a Parquet file; timestamps become seconds since the column's first.

    The unit of a column is the entry `unit` or `units` of its metadata.

    Raises InputError if the file is damaged; when numbers are loaded, if a column holds none.
    """
    import pyarrow as pa
    from pyarrow import parquet

    damaged = (pa.ArrowException, OSError, ValueError)
    with (
        refuse_damaged(path, "is not a whole Parquet file", *damaged),
        parquet.ParquetFile(path) as file,
    ):
        schema, rows = file.schema_arrow, file.metadata.num_rows
    require_channels(path, len(schema))
    units = []
    for field in schema:
        metadata = field.metadata or {}
        stated = metadata.get(b"unit", metadata.get(b"units", b"")).decode(errors="replace")
        units.append("s" if pa.types.is_timestamp(field.type) else stated)
    # Texts may hold numbers. As a dictionary, a long text that all rows repeat is read only once.
    is_text = (pa.types.is_string, pa.types.is_large_string)
    texts = [field.name for field in schema if any(test(field.type) for test in is_text)]

    def read(places: Sequence[int], most: int) -> list[Array]:
        with (
            refuse_damaged(path, "is damaged", *damaged),
            parquet.ParquetFile(
                path, page_checksum_verification=True, read_dictionary=texts
            ) as file,
        ):
            return [_read_column(path, file, place, most) for place in places]

    return ChannelTable(path, "Parquet", tuple(schema.names), tuple(units), read, rows)


def _read_column(path: Path, file: parquet.ParquetFile, place: int, most: int) -> Array:
    """Return the first numbers of a column, at most so many."""
    import pyarrow as pa

    field = file.schema_arrow.field(place)
    number = file.schema_arrow.names[:place].count(field.name)  # among the columns of the same name
    is_time = pa.types.is_timestamp(field.type)
    parts: list[Array] = []
    count = 0
    for batch in file.iter_batches(batch_size=1 << 20, columns=[field.name], use_threads=False):
        part = batch.column(number)
        try:
            if is_time:
                part = part.cast(pa.timestamp("ns")).cast(pa.int64())
            elif pa.types.is_dictionary(part.type):
                part = part.dictionary.cast(pa.float64()).take(part.indices)
            else:
                part = part.cast(pa.float64())
        except (pa.ArrowInvalid, pa.ArrowNotImplementedError):
            kind = field.type.value_type if pa.types.is_dictionary(field.type) else field.type
            raise InputError(f"{path}: column {field.name} holds no numbers ({kind})") from None
        parts.append(part.to_numpy(zero_copy_only=False)[: most - count])
        count += len(parts[-1])
        if count >= most:
            break
    values = np.concatenate(parts) if parts else np.empty(0)
    if is_time and len(values):
        return np.asarray((values - values[0]) * 1e-9, dtype=float)
    return np.array(values, dtype=float)
