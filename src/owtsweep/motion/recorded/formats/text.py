"""Read text tables: CSV, TSV, columns separated by blanks, FAST's .out; also gzip-compressed."""

from __future__ import annotations

import codecs
import io
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.motion.recorded.formats.iso_times import IsoTimes
from owtsweep.motion.recorded.formats.streams import TextStream, read_rows
from owtsweep.motion.recorded.formats.table import ChannelTable, refuse, shorten
from owtsweep.motion.recorded.formats.text_layout import (
    MISSING,
    Layout,
    find_layout,
    is_value,
    split_fields,
)

if TYPE_CHECKING:
    import pyarrow as pa

    #: Column -> its values in one block: numbers, or a pyarrow array of strings for times.
    Parsed = Mapping[str, Array | pa.StringArray]

#: The layout is found from this many bytes at the start of the file.
HEAD = 1 << 18


def open_text(path: Path) -> ChannelTable:
    """Open a text table.

    Raises InputError if the file is empty, is not text in UTF-8 or Latin-1, has no table of
        numbers, or has commas of unclear meaning (decimal commas or separators).
    """
    layout = find_layout(path, _read_head(path))
    notes: list[str] = []
    load = partial(load_columns, path, layout, notes)
    word = {",": "commas", ";": "semicolons", "\t": "tabs", " ": "blanks"}[layout.delimiter]
    if layout.decimal == ",":
        word += ", decimal commas"
    form = f"text, columns between {word}"
    return ChannelTable(path, form, layout.names, layout.units, load, notes=notes)


def _read_head(path: Path) -> list[str]:
    """Return the first lines, of at most `HEAD` bytes; a line that this cuts is left out."""
    with TextStream(path) as stream:
        raw = stream.read(HEAD)
    if not raw.strip():
        raise refuse(path, "is empty")
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        raise refuse(path, "is text in UTF-16; save it as UTF-8")
    if b"\0" in raw:
        raise refuse(path, "holds binary data, not text; give it the extension of its format")
    try:
        text = codecs.getincrementaldecoder("utf-8-sig")().decode(raw)  # the last letter may be cut
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    return lines[:-1] if len(raw) == HEAD and len(lines) > 1 else lines


def load_columns(
    path: Path, layout: Layout, notes: list[str], names: Sequence[str], rows: int | None
) -> Mapping[str, Array]:
    """Load the first `rows` values of columns, block by block; `notes` gets what is left out."""
    times = {n: IsoTimes(path, n, layout.times[n]) for n in names if n in layout.times}
    parse = _parse_blanks if layout.delimiter == " " else _parse_delimited
    columns: dict[str, Array] = {name: np.empty(0) for name in names}
    count, skipped = 0, layout.first
    split = partial(split_fields, delimiter=layout.delimiter)
    for block in read_rows(path, len(layout.names), split, is_value, notes):
        if not block.strip():
            continue
        parsed = parse(path, layout, block, skipped, names)
        skipped = 0
        stop = count + len(parsed[names[0]]) if names else count
        for name in names:
            values = parsed[name]
            if stop > len(columns[name]):
                longer = np.empty(max(2 * len(columns[name]), stop))  # takes memory when written to
                longer[:count] = columns[name][:count]
                columns[name] = longer
            columns[name][count:stop] = times[name].convert(values) if name in times else values
        count = stop
        if rows is not None and count >= rows:
            break
    stop = count if rows is None else min(rows, count)
    return {name: column[:stop] for name, column in columns.items()}


def _parse_delimited(
    path: Path, layout: Layout, block: bytes, skipped: int, names: Sequence[str]
) -> Parsed:
    """Parse a block with pyarrow, without its first `skipped` lines.

    pyarrow's own streaming reader is not used, because its thread may outlive an error.
    """
    import pyarrow as pa
    from pyarrow import csv as arrow_csv

    convert = arrow_csv.ConvertOptions(
        include_columns=list(names),
        column_types={n: pa.string() if n in layout.times else pa.float64() for n in names},
        null_values=list(MISSING),
        strings_can_be_null=True,
        decimal_point=layout.decimal,
    )
    how = arrow_csv.ReadOptions(skip_rows=skipped, column_names=list(layout.names))
    parse = arrow_csv.ParseOptions(delimiter=layout.delimiter)
    try:
        table = arrow_csv.read_csv(pa.BufferReader(block), how, parse, convert)
    except pa.ArrowException as error:
        raise _not_numbers(path, error) from None
    return {
        n: table.column(n).combine_chunks() if n in layout.times else table.column(n).to_numpy()
        for n in names
    }


def _parse_blanks(
    path: Path, layout: Layout, block: bytes, skipped: int, names: Sequence[str]
) -> Parsed:
    """Parse a block with pandas, because pyarrow cannot split a line at runs of blanks."""
    import pandas as pd
    import pyarrow as pa

    if skipped:
        block = b"".join(block.splitlines(keepends=True)[skipped:])
    types = {name: "str" if name in layout.times else "float64" for name in names}
    try:
        frame = pd.read_csv(
            io.BytesIO(block), sep=r"\s+", header=None, names=layout.names,
            usecols=list(names), dtype=types, na_values=list(MISSING), decimal=layout.decimal,
            encoding_errors="replace",
        )  # fmt: skip
    except (ValueError, pd.errors.ParserError) as error:
        raise _not_numbers(path, error) from None
    columns = len(layout.names)
    if len(block.split()) != columns * len(frame):  # pandas takes a short row as missing values
        for line in block.decode("utf-8", "replace").splitlines():
            fields = split_fields(line, " ")
            if len(fields) not in (0, columns):
                raise refuse(path, f"{len(fields)} fields, not {columns}, are in {line[:60]!r}")
    return {
        n: pa.array(frame[n], pa.string(), from_pandas=True)
        if n in layout.times
        else frame[n].to_numpy(dtype=float)
        for n in names
    }


def _not_numbers(path: Path, error: Exception) -> InputError:
    return refuse(path, f"cannot be read as a table of numbers ({shorten(error, 160)})")
