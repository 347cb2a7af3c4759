"""Read NumPy archives (.npz, without pickled objects) and Parquet files."""

from __future__ import annotations

import math
import tokenize
import zipfile
import zlib
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

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


class Variable(NamedTuple):
    """An array of a file, whose numbers are read on demand."""

    name: str
    shape: tuple[int, ...]  # rows; rows and columns
    real: bool  # whether it is an array of real numbers
    load: Callable[[], Array]  # shaped as it


def open_arrays(
    path: Path,
    form: str,
    variables: Iterable[Variable],
    damaged: tuple[str, *tuple[type[Exception], ...]],
) -> ChannelTable:
    """Open the arrays of a file; what is no array of real numbers in rows is left out, and told.

    An array `a` of shape (n,) becomes the channel a; one of shape (n, 1) to (n, 3) the channels
    a_x, a_y, a_z; one with more columns a_1, a_2, ...

    form: the format in words. damaged: what is said of a damaged file, and the errors of one.
    Raises InputError if there is no array; when numbers are loaded, if channels differ in length.
    """
    places: list[tuple[str, Variable, int]] = []  # channel, array, column
    left_out = []
    for variable in variables:
        name, shape, real, _ = variable
        if not real or len(shape) not in (1, 2):
            left_out.append(name)
            continue
        columns = math.prod(shape[1:])
        require_channels(path, columns)
        require_room(path, shape[0], columns, shape[0])
        ends = [f"_{AXES[k] if columns <= len(AXES) else k + 1}" for k in range(columns)]
        ends = ends if len(shape) == 2 else [""]
        places += [(name + end, variable, column) for column, end in enumerate(ends)]
    notes = [f"no arrays of real numbers, left out: {', '.join(left_out)}"] if left_out else []
    more = f" ({notes[0]})" if notes else ""
    require(bool(places), f"{path}: has no array of numbers: save plain vectors{more}")

    def read(wanted: Sequence[int], rows: int) -> list[Array]:
        lengths = {places[each][0]: places[each][1].shape[0] for each in wanted}
        told = ", ".join(f"{name} {length}" for name, length in lengths.items())
        require(
            len({*lengths.values()}) < 2,
            f"{path}: channels differ in length ({told}): save them equally long",
        )
        found: dict[int, Array] = {}
        for variable in dict.fromkeys(places[each][1] for each in wanted):  # one at a time
            with refuse_damaged(path, *damaged):
                table = variable.load().reshape(variable.shape[0], math.prod(variable.shape[1:]))
            for each in wanted:
                if places[each][1] is variable:
                    found[each] = np.array(table[:rows, places[each][2]], dtype=float)
        return [found[each] for each in wanted]

    names = tuple(name for name, _, _ in places)
    longest = max(variable.shape[0] for _, variable, _ in places)
    return ChannelTable(path, form, names, ("",) * len(names), read, longest, notes)


def open_npz(path: Path) -> ChannelTable:
    """Open a NumPy archive; raises InputError if it is damaged or holds pickled objects."""
    with refuse_damaged(path, *DAMAGED), zipfile.ZipFile(path) as archive:
        variables = [_read_header(path, archive, member) for member in archive.infolist()]
    return open_arrays(path, "NumPy archive", variables, DAMAGED)


def _read_header(path: Path, archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> Variable:
    file = member.filename
    variable = Variable(file.removesuffix(".npy"), (), False, partial(_load, path, file))
    with archive.open(member) as stream:
        read_header = HEADERS.get(np.lib.format.read_magic(stream))
        if read_header is None:
            return variable
        shape, _, dtype = read_header(stream)
        plain = "which can run code: save plain arrays"
        require(not dtype.hasobject, f"{path}: holds pickled objects, {plain}")
        if dtype.kind not in "fiub":
            return variable
        size, there = math.prod(shape) * dtype.itemsize, member.file_size
        require(
            stream.tell() + size <= there,
            f"{path}: {file} is to hold {size} bytes of numbers, but holds {there}",
        )
    return variable._replace(shape=tuple(shape), real=True)


def _load(path: Path, file: str) -> Array:
    with zipfile.ZipFile(path) as archive, archive.open(file) as stream:
        return np.lib.format.read_array(stream, allow_pickle=False)


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
    strings = (pa.string(), pa.large_string())
    texts = [field.name for field in schema if field.type in strings]

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
        parts.append(part.to_numpy(zero_copy_only=False))
        if sum(map(len, parts)) >= most:
            break
    values = np.concatenate(parts)[:most] if parts else np.empty(0)
    return (values - values[:1]) * 1e-9 if is_time else values
