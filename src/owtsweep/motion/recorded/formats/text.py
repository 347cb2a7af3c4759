"""Read text tables: CSV, TSV, columns separated by blanks, FAST's .out; also gzip-compressed.

The reader finds the layout from the first lines. Data begin at the first two lines that hold mostly
numbers and have the same number of fields. The line above them holds the names; if it holds units,
the names are one line higher. Anything above the names is skipped.
"""

from __future__ import annotations

import gzip
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import IO

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.motion.recorded.formats.table import ChannelTable, number_repeats, refuse, shorten

#: The layout is found from this many bytes at the start of the file.
HEAD = 1 << 18

MISSING = (
    *("", "nan", "NaN", "NAN", "-nan", "-NaN", "1.#QNAN", "-1.#IND", "#N/A", "NA", "N/A", "n/a"),
    *("null", "NULL", "None", "none", "-", "inf", "-inf", "Inf", "-Inf"),
)

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?$")
_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+([eE][+-]?\d+)?$")
_UNIT_AT_END = re.compile(r"^(.*?)[\s_]*[\[(]([^\[\]()]*)[\])]\s*$")
_BRACKETED = re.compile(r"^[\[(].*[\])]$")


@dataclass(frozen=True)
class Layout:
    """The layout of a text table.

    Attributes
    ----------
    delimiter
        The character between fields; " " stands for any run of blanks.
    first
        Number of lines above the data.
    names, units
        Name and unit of each column; a unit is "" if the file states none.
    """

    delimiter: str
    first: int
    names: tuple[str, ...]
    units: tuple[str, ...]


def open_text(path: Path) -> ChannelTable:
    """Open a text table.

    Raises
    ------
    InputError
        If the file is empty, has no two lines of numbers, or has decimal commas.
    """
    layout = find_layout(path, _read_head(path))
    load = partial(_load_blanks if layout.delimiter == " " else _load_delimited, path, layout)
    word = {",": "commas", ";": "semicolons", "\t": "tabs", " ": "blanks"}[layout.delimiter]
    return ChannelTable(path, f"text, columns between {word}", layout.names, layout.units, load)


def _open(path: Path) -> IO[bytes]:
    if path.suffix.lower() == ".gz":
        return gzip.open(path)  # type: ignore[return-value]
    return path.open("rb")


def _read_head(path: Path) -> list[str]:
    """Read the first lines of a file, at most `HEAD` bytes; an incomplete last line is dropped."""
    try:
        with _open(path) as file:
            raw = file.read(HEAD)
    except (OSError, EOFError) as error:
        raise refuse(path, f"cannot be read ({error})") from None
    if not raw.strip():
        raise refuse(path, "is empty")
    if b"\0" in raw:
        raise refuse(path, "holds binary data, not text; give it the extension of its format")
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    return lines[:-1] if len(raw) == HEAD and len(lines) > 1 else lines


def split_fields(line: str, delimiter: str) -> list[str]:
    """Split a line into fields, and remove blanks and quotes around each field."""
    if delimiter == " ":
        return [field.strip('"') for field in line.split()]
    return [field.strip().strip('"').strip() for field in line.rstrip("\r\n").split(delimiter)]


def find_layout(path: Path, lines: list[str]) -> Layout:
    """Find the delimiter, the names and units of the columns, and the first line of the data.

    Raises
    ------
    InputError
        If there is no table of numbers, or if its numbers have decimal commas.
    """
    for first, line in enumerate(lines):
        if not line.strip():
            continue
        delimiter = _find_delimiter(line)
        fields = split_fields(line, delimiter)
        follower = next((text for text in lines[first + 1 :] if text.strip()), line)
        below = split_fields(follower, delimiter)
        if not len(fields) == len(below) > 1 or not (_is_data(fields) and _is_data(below)):
            continue
        with_comma = [field for field in fields if _DECIMAL_COMMA.match(field)]
        if delimiter != "," and with_comma:
            raise refuse(
                path,
                f"line {first + 1} has decimal commas ({with_comma[0]}): "
                "write numbers with a point",
            )
        names, units = _read_header(lines[:first], delimiter, len(fields))
        return Layout(delimiter, first, names, units)
    raise refuse(
        path,
        "has no table of numbers (at least two lines and two columns, separated by commas, "
        "semicolons, tabs or blanks)",
    )


def _find_delimiter(line: str) -> str:
    for candidate in (";", "\t"):
        if candidate in line.strip():
            return candidate
    # "1,5 2,25" is separated by blanks and has decimal commas; "1,2, 3" is separated by commas
    blanks = line.split()
    if len(blanks) > 1 and all(_DECIMAL_COMMA.match(field) for field in blanks):
        return " "
    return "," if "," in line else " "


def _is_data(fields: list[str]) -> bool:
    numbers = sum(1 for f in fields if _NUMBER.match(f) or _DECIMAL_COMMA.match(f))
    missing = sum(1 for f in fields if f in MISSING)  # none of these looks like a number
    return numbers > 0 and 2 * (numbers + missing) >= len(fields)


def _read_header(above: list[str], delimiter: str, count: int) -> tuple[tuple[str, ...], ...]:
    """Read names and units of `count` columns from the lines above the data.

    Without names, the columns are called 1, 2, 3, ...
    """
    rows = [split_fields(line.lstrip("#!%").strip(), delimiter) for line in above if line.strip()]
    units = [""] * count
    if rows and len(rows[-1]) == count and all(_BRACKETED.match(f) or not f for f in rows[-1]):
        units = [field.strip("[]() ") for field in rows.pop()]
    if not rows or len(rows[-1]) != count:
        return tuple(str(number + 1) for number in range(count)), tuple(units)
    names = []
    for place, field in enumerate(rows[-1]):
        parts = _UNIT_AT_END.match(field)
        if parts and parts[1] and not units[place]:
            names.append(parts[1])
            units[place] = parts[2].strip()
        else:
            names.append(field or str(place + 1))
    return number_repeats(names), tuple("" if unit in ("-", "none") else unit for unit in units)


def _load_delimited(
    path: Path, layout: Layout, names: Sequence[str], rows: int | None
) -> Mapping[str, Array]:
    """Load columns with pyarrow, block by block, so that only the wanted columns use memory."""
    import pyarrow as pa
    from pyarrow import csv

    columns: dict[str, Array] = {name: np.empty(0) for name in names}
    count = 0
    try:
        with _open(path) as file:
            reader = csv.open_csv(
                pa.PythonFile(file, mode="r"),
                read_options=csv.ReadOptions(
                    skip_rows=layout.first, column_names=list(layout.names), block_size=1 << 22
                ),
                parse_options=csv.ParseOptions(delimiter=layout.delimiter),
                convert_options=csv.ConvertOptions(
                    include_columns=list(names),
                    column_types={name: pa.float64() for name in names},
                    null_values=list(MISSING),
                ),
            )
            for batch in reader:
                stop = count + batch.num_rows
                for name in names:
                    if stop > len(columns[name]):
                        columns[name] = _lengthen(columns[name], count, stop)
                    # a copy, so that Arrow can reuse its block
                    columns[name][count:stop] = batch.column(name).to_numpy(zero_copy_only=False)
                count = stop
                if rows is not None and count >= rows:
                    break
    except (pa.ArrowInvalid, OSError, EOFError) as error:
        raise _not_numbers(path, error) from None
    stop = count if rows is None else min(rows, count)
    return {name: column[:stop] for name, column in columns.items()}


def _not_numbers(path: Path, error: Exception) -> InputError:
    return refuse(path, f"cannot be read as a table of numbers ({shorten(error, 160)})")


def _lengthen(column: Array, count: int, least: int) -> Array:
    """Copy the first `count` values to an array twice as long, or of length `least` if longer.

    The rest of the array takes no memory until values are written to it.
    """
    result = np.empty(max(2 * len(column), least))
    result[:count] = column[:count]
    return result


def _load_blanks(
    path: Path, layout: Layout, names: Sequence[str], rows: int | None
) -> Mapping[str, Array]:
    """Load columns with pandas, because pyarrow cannot split at runs of blanks."""
    import pandas as pd

    try:
        with _open(path) as file:
            frame = pd.read_csv(
                file, sep=r"\s+", skiprows=layout.first, header=None, names=layout.names,
                usecols=list(names), nrows=rows, dtype="float64", na_values=list(MISSING),
            )  # fmt: skip
    except (ValueError, OSError, EOFError, pd.errors.ParserError) as error:
        raise _not_numbers(path, error) from None
    return {name: frame[name].to_numpy(dtype=float) for name in names}
