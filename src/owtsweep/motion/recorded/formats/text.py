"""Read text tables: CSV, TSV, columns separated by blanks, FAST's .out; also gzip-compressed."""

from __future__ import annotations

import codecs
import re
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, printable, require
from owtsweep.motion.recorded.formats.streams import read_blocks, read_chunks
from owtsweep.motion.recorded.formats.table import ChannelTable, refuse_damaged, shorten
from owtsweep.motion.recorded.formats.text_layout import (
    ISO_PATTERN,
    MISSING,
    ZONE,
    Layout,
    find_layout,
    is_iso_time,
    is_value,
    split_fields,
)

if TYPE_CHECKING:
    import pyarrow as pa

#: The layout is found from this many bytes at the start of the file.
HEAD = 1 << 18
#: Most lines of text below a table. More are not left out, so the file is refused.
MOST_LINES = 20
#: If this many lines before the last one have one length, a shorter last line was cut off.
ALIKE = 20


def open_text(path: Path) -> ChannelTable:
    """Open a text table.

    Raises InputError if the file is no text in UTF-8 or Latin-1, has no table of numbers, or has
        commas of unclear meaning.
    """
    layout = find_layout(path, _read_head(path))
    notes: list[str] = []
    read = partial(read_columns, path, layout, notes)
    word = {",": "commas", ";": "semicolons", "\t": "tabs", " ": "blanks"}[layout.delimiter]
    if layout.decimal == ",":
        word += ", decimal commas"
    form = f"text, columns between {word}"
    return ChannelTable(path, form, layout.names, layout.units, read, notes=notes)


def _read_head(path: Path) -> list[str]:
    raw = next(read_chunks(path, HEAD), b"")
    require(raw.strip() != b"", f"{path}: is empty")
    utf_16 = raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    require(not utf_16, f"{path}: is text in UTF-16; save it as UTF-8")
    require(
        b"\0" not in raw,
        f"{path}: holds binary data, not text; give it the extension of its format",
    )
    try:
        text = codecs.getincrementaldecoder("utf-8-sig")().decode(raw)  # the last letter may be cut
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    return lines[:-1] if len(raw) == HEAD and len(lines) > 1 else lines


def read_columns(
    path: Path, layout: Layout, notes: list[str], places: Sequence[int], rows: int
) -> list[Array]:
    """Read the first `rows` values of columns, block by block; `notes` gets what is left out."""
    parts: list[list[Array]] = [[np.empty(0)] for _ in places]
    count, skipped = 0, layout.first
    for block, is_last in read_blocks(path):
        if is_last:
            block = _without_ending(block, layout, notes)
        if not block.strip():
            continue
        for part, values in zip(parts, _parse(path, layout, block, skipped, places), strict=True):
            part.append(values)
        skipped = 0
        count += len(parts[0][-1])
        if count >= rows:
            break
    parts.reverse()
    return [np.concatenate(parts.pop())[:rows] for _ in places]  # frees parts that are joined


def _without_ending(block: bytes, layout: Layout, notes: list[str]) -> bytes:
    lines = block.splitlines(keepends=True)
    texts = [line.decode("utf-8", "replace").rstrip("\r\n") for line in lines]
    if lines and not lines[-1].endswith((b"\n", b"\r")) and _is_cut(texts, layout):
        notes.append(f"the last line was cut off and is left out: {_quote(texts[-1])}")
        del lines[-1], texts[-1]
    place = len(texts)
    while place and not _is_row(texts[place - 1], layout):
        place -= 1
    below = [text for text in texts[place:] if text.strip()]
    if 0 < len(below) <= MOST_LINES:
        notes.append(
            f"{len(below)} line(s) below the table are left out, the first is {_quote(below[0])}"
        )
        del lines[place:]
    return b"".join(lines)


def _is_row(text: str, layout: Layout) -> bool:
    # as many fields as columns, one with a value; or values alone, whose wrong number is refused
    values = [is_value(each) for each in split_fields(text, layout.delimiter) if text.strip()]
    return any(values) if len(values) == len(layout.names) else bool(values) and all(values)


def _is_cut(texts: Sequence[str], layout: Layout) -> bool:
    fields, count = split_fields(texts[-1], layout.delimiter), len(layout.names)
    if not fields or len(fields) > count or not is_value(fields[0]):
        return False
    before = {len(text) for text in texts[-1 - ALIKE : -1]}
    shorter = len(texts) > ALIKE and len(before) == 1 and len(texts[-1]) < min(before)
    return len(fields) < count or not is_value(fields[-1]) or shorter


def _quote(text: str) -> str:
    return f"'{printable(text.strip()[:40])}'"


def _parse(
    path: Path, layout: Layout, block: bytes, skipped: int, places: Sequence[int]
) -> list[Array]:
    # pyarrow's own streaming reader is not used: its thread may outlive an error
    import pyarrow as pa
    from pyarrow import csv as arrow_csv

    if layout.delimiter == " ":  # pyarrow cannot split a line at runs of blanks
        lines = block.splitlines()[skipped:]
        block, skipped = b"\n".join(b" ".join(line.split()) for line in lines), 0
    names = [str(place) for place in range(len(layout.names))]
    convert = arrow_csv.ConvertOptions(
        include_columns=[names[place] for place in places],
        column_types={
            name: pa.string() if place in layout.times else pa.float64()
            for place, name in enumerate(names)
        },
        null_values=list(MISSING),
        strings_can_be_null=True,
        decimal_point=layout.decimal,
    )
    how = arrow_csv.ReadOptions(skip_rows=skipped, column_names=names)
    parse = arrow_csv.ParseOptions(delimiter=layout.delimiter)
    try:
        table = arrow_csv.read_csv(pa.BufferReader(block), how, parse, convert)
    except pa.ArrowException as error:
        reason = f"cannot be read as a table of numbers ({shorten(error, 160)})"
        raise InputError(f"{path}: {reason}") from None
    return [
        to_seconds(column, layout.times[place], f"{path}: column {layout.names[place]}")
        if place in layout.times
        else column.to_numpy()
        for place, column in zip(places, table.columns, strict=True)
    ]


def to_seconds(texts: pa.ChunkedArray, first: str, where: str) -> Array:
    """Return times in ISO 8601 as seconds from the `first` one; NaN where a text is missing.

    Raises InputError, which begins with `where`, if a text or the first is not in ISO 8601, or only
    some times have an offset from UTC.
    """
    import pandas as pd
    import pyarrow.compute as pc

    require(
        is_iso_time(first),
        f"{where} holds times like {first}: write date and time in ISO 8601, e.g. "
        "2024-05-01T12:00:00.000Z, or seconds",
    )
    wrong = texts.filter(pc.invert(pc.match_substring_regex(texts, "^" + ISO_PATTERN)))
    if len(wrong):
        raise InputError(f"{where} holds times in ISO 8601, but also {wrong[0].as_py()[:40]!r}")
    zoned = pc.unique(pc.match_substring_regex(texts, ZONE + "$").drop_null()).to_pylist()
    require(
        {*zoned} <= {re.search(ZONE + "$", first) is not None},
        f"{where}: some times state Z or an offset from UTC, others do not; write them in one way",
    )
    with refuse_damaged(where, "no such time", ValueError, OverflowError):
        begin = pd.to_datetime(first.replace(",", "."), format="ISO8601", utc=True)
        points = pc.replace_substring(texts, ",", ".").to_pandas()
        since = pd.to_datetime(points, format="ISO8601", utc=True) - begin
    since = since.to_numpy("timedelta64[ns]")
    return np.where(np.isnat(since), np.nan, since.astype(np.int64) * 1e-9)
