"""Read text tables: CSV, TSV, columns separated by blanks, FAST's .out; also gzip-compressed."""

from __future__ import annotations

import codecs
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, printable, require
from owtsweep.motion.recorded.formats.streams import TextStream, read_blocks
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

    #: Column -> its values in one block: numbers, or a pyarrow array of strings for times.
    Parsed = Mapping[str, Array | pa.StringArray]

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
    with TextStream(path) as stream:
        raw = stream.read(HEAD)
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
    names = [layout.names[place] for place in places]
    times = {n: IsoTimes(path, n, layout.times[n]) for n in names if n in layout.times}
    columns: dict[str, Array] = {name: np.empty(0) for name in names}
    count, skipped = 0, layout.first
    for block, is_last in read_blocks(path):
        if is_last:
            block = _without_ending(block, layout, notes)
        if not block.strip():
            continue
        parsed = _parse(path, layout, block, skipped, names)
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
        if count >= rows:
            break
    stop = min(rows, count)
    return [columns[name][:stop] for name in names]


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


def _parse(path: Path, layout: Layout, block: bytes, skipped: int, names: Sequence[str]) -> Parsed:
    # pyarrow's own streaming reader is not used: its thread may outlive an error
    import pyarrow as pa
    from pyarrow import csv as arrow_csv

    if layout.delimiter == " ":  # pyarrow cannot split a line at runs of blanks
        lines = block.splitlines()[skipped:]
        block, skipped = b"\n".join(b" ".join(line.split()) for line in lines), 0
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
        reason = f"cannot be read as a table of numbers ({shorten(error, 160)})"
        raise InputError(f"{path}: {reason}") from None
    return {
        n: table.column(n).combine_chunks() if n in layout.times else table.column(n).to_numpy()
        for n in names
    }


class IsoTimes:
    """Converts a column of times in ISO 8601, piece by piece, to seconds from the first time.

    `example` is the first field of the column `name`; InputError is raised if its form is another.
    """

    def __init__(self, path: Path, name: str, example: str) -> None:
        self._path, self._name = path, name
        self._first: int | None = None
        self._zoned: set[bool] = set()
        require(
            is_iso_time(example),
            f"{path}: column {name} holds times like {example}: write date and time in ISO 8601, "
            "e.g. 2024-05-01T12:00:00.000Z, or seconds",
        )

    def convert(self, texts: pa.StringArray) -> Array:
        """Return the next times in s from the column's first; NaN where a text is missing.

        Raises InputError if a text is not in ISO 8601, or only some times have an offset from UTC.
        """
        import pandas as pd
        import pyarrow.compute as pc

        where = f"{self._path}: column {self._name}"
        there = pc.is_valid(texts).to_numpy(zero_copy_only=False)
        good = pc.match_substring_regex(texts, "^" + ISO_PATTERN).fill_null(True)
        wrong = texts.filter(pc.invert(good))
        if len(wrong):
            raise InputError(f"{where} holds times in ISO 8601, but also {wrong[0].as_py()[:40]!r}")
        zoned = pc.match_substring_regex(texts, ZONE + "$")
        self._zoned |= {*zoned.drop_null().unique().to_pylist()}
        require(
            len(self._zoned) < 2,
            f"{where}: some times state Z or an offset from UTC, others do not; write them in one "
            "way",
        )
        series = pc.replace_substring(texts, ",", ".").to_pandas()
        with refuse_damaged(where, "no such time", ValueError, OverflowError):
            moments = pd.to_datetime(series, format="ISO8601", utc=True).dt.tz_localize(None)
        numbers = moments.to_numpy(dtype="datetime64[ns]").view(np.int64)
        if self._first is None and there.any():
            self._first = int(numbers[there][0])
        result = np.full(len(numbers), np.nan)
        result[there] = (numbers[there] - (self._first or 0)) * 1e-9
        return result
