"""Find the layout of a text table: delimiter, names, units, decimal character, times with dates.

The layout is found from the first lines of the file. The data begin at the first of two successive
lines that have equally many fields, at least half of which are numbers, times or missing values.
The line above the data holds the names of the columns. If that line holds units, the names are one
line higher. All lines above the names are skipped.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from owtsweep.errors import InputError
from owtsweep.motion.recorded.formats.table import LONGEST_NAME
from owtsweep.motion.recorded.units import find_dimension

#: The unit of a column of such times, in place of one that the file states.
ISO_TIME = "ISO 8601"

ZONE = r"(Z|[+-]\d\d(:?\d\d)?)"
#: Date, T or a blank, time of day, perhaps Z or the offset from UTC.
ISO_PATTERN = r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d([.,]\d{1,9})?)?" + ZONE + "?$"
_ISO = re.compile(ISO_PATTERN)
#: Other dates and times of day, whose meaning would be a guess: 01/05/2024 12:00, 1.5.24, 12:00:00.
_UNCLEAR = re.compile(
    r"(\d{1,4}[-/.]\d{1,2}[-/.]\d{1,4}([T ].{0,40})?|\d{1,2}:\d\d(:\d\d([.,]\d*)?)?.{0,6})$"
)
_DATE, _CLOCK = re.compile(r"\d{4}-\d\d-\d\d$"), re.compile(r"\d\d:\d\d")


def is_iso_time(field: str) -> bool:
    """Return whether a field is a date with a time of day in ISO 8601."""
    return _ISO.match(field) is not None


def is_date_or_clock(field: str) -> bool:
    """Return whether a field is a date or a time of day, in ISO 8601 or not."""
    return is_iso_time(field) or _UNCLEAR.match(field) is not None


MISSING = (
    *("", "nan", "NaN", "NAN", "-nan", "-NaN", "1.#QNAN", "-1.#IND", "#N/A", "NA", "N/A", "n/a"),
    *("null", "NULL", "None", "none", "-", "inf", "-inf", "Inf", "-Inf"),
)

#: A number, with a decimal point or a decimal comma.
_NUMBER = re.compile(r"[+-]?(\d+(\.\d*|,\d+)?|\.\d+)([eEdD][+-]?\d+)?$")
#: Numbers with a comma that may be a decimal comma, or may separate thousands.
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}$")
_INTEGER = re.compile(r"[+-]?\d+$")
_TIME = re.compile(r"\W*(t|time.*)$", re.IGNORECASE)
_UNIT_AT_END = re.compile(r"^(.*?)[\s_]*[\[(]([^\[\]()]*)[\])]\s*$")
_BRACKETED = re.compile(r"^[\[(].*[\])]$")


@dataclass(frozen=True)
class Layout:
    """The layout of a text table."""

    delimiter: str  # " " stands for any run of blanks
    first: int  # lines above the data
    names: Sequence[str]
    units: Sequence[str]  # "" where the file states none
    decimal: str  # "." or ","
    times: Mapping[int, str]  # place of a column of dates or times of day -> its first field


def split_fields(line: str, delimiter: str) -> list[str]:
    """Return the fields of a line, without blanks and quotes around a field."""
    if delimiter == " ":
        return [field.strip('"') for field in line.split()]
    if '"' in line and len(line) < 100_000:  # the module csv limits the length of a field
        quoted = next(csv.reader([line.strip("\r\n")], delimiter=delimiter, skipinitialspace=True))
        return [field.strip() for field in quoted]
    return [field.strip().strip('"').strip() for field in line.rstrip("\r\n").split(delimiter)]


def find_layout(path: Path, lines: list[str]) -> Layout:
    """Find the layout of a text table from the first lines of the file.

    Raises InputError if the lines hold no table of numbers, or commas of unclear meaning.
    """
    written = [(number, line) for number, line in enumerate(lines) if line.strip()]
    for place, (first, line) in enumerate(written):
        delimiter = _find_delimiter(line)
        fields = split_fields(line, delimiter)
        follower = written[min(place + 1, len(written) - 1)][1]
        below = split_fields(follower, delimiter)
        if not len(fields) == len(below) > 1 or not (_is_data(fields) and _is_data(below)):
            continue
        if delimiter == " " and _DATE.match(fields[0]) and _CLOCK.match(fields[1]):
            raise InputError(
                f"{path}: line {first + 1} has date and time as two columns: write T between them "
                f"({fields[0]}T{fields[1]}), or commas between the columns"
            )
        data = [split_fields(text, delimiter) for _, text in written[place:]]
        decimal = _find_decimal(path, first + 1, data)
        header = [text for _, text in written[:place]]
        if delimiter == "," and header and decimal == ".":
            _refuse_commas_for_all(path, first, fields, header[-1])
        names, units = _read_header(header, delimiter, len(fields))
        times = {place: field for place, field in enumerate(fields) if is_date_or_clock(field)}
        units = [ISO_TIME if place in times else unit for place, unit in enumerate(units)]
        return Layout(delimiter, first, names, units, decimal, times)
    raise InputError(
        f"{path}: has no table of numbers (at least two lines and two columns, separated by "
        "commas, semicolons, tabs or blanks)"
    )


def _find_decimal(path: Path, line: int, data: list[list[str]]) -> str:
    """Return "." or ",", the decimal character of fields of data, which begin at `line`."""
    numbers = [field for fields in data for field in fields if _NUMBER.match(field)]
    commas, points = ([field for field in numbers if mark in field] for mark in ",.")
    if not commas or (points and commas[0] not in data[0]):  # a comma in a text further down
        return "."
    hint = "write numbers with a decimal point and without other separators"
    if points:
        both = f"{commas[0]} and {points[0]}"
        raise InputError(f"{path}: line {line} on has numbers like {both}: {hint}")
    if all(_THOUSANDS.match(field) for field in commas):
        both = f"{commas[0].replace(',', '')} or {commas[0].replace(',', '.')}"
        raise InputError(f"{path}: is {commas[0]} from line {line} on {both}? {hint}")
    return ","


def _refuse_commas_for_all(path: Path, first: int, fields: list[str], header: str) -> None:
    """Refuse commas between columns that may also be decimal commas, as in `0,05,1,25`."""
    names = split_fields(header.lstrip("#!%").strip(), ",")
    parts = len(fields)
    whole = all(_INTEGER.match(field) for field in fields)
    if whole and len(names) < parts <= 2 * len(names) and any(map(_TIME.match, names)):
        raise InputError(
            f"{path}: line {first + 1} has {parts} numbers below {len(names)} names: if its commas "
            "are decimal commas, write points instead, or write semicolons between the columns"
        )


def _find_delimiter(line: str) -> str:
    for candidate in (";", "\t"):
        if candidate in line.strip():
            return candidate
    # "1 2,25" is separated by blanks and has decimal commas; "1,2, 3" is separated by commas
    blanks = line.split()
    if len(blanks) > 1 and all(map(_NUMBER.match, blanks)):
        return " "
    return "," if "," in line else " "


def _is_data(fields: list[str]) -> bool:
    return any(map(_NUMBER.match, fields)) and 2 * sum(map(is_value, fields)) >= len(fields)


def is_value(field: str) -> bool:
    """Return whether a field is a number, a date, a time of day, or a sign of a missing value."""
    return bool(_NUMBER.match(field)) or field in MISSING or is_date_or_clock(field)


def _read_header(above: list[str], delimiter: str, count: int) -> tuple[list[str], list[str]]:
    rows = [split_fields(line.lstrip("#!%").strip(), delimiter) for line in above[-2:]]
    units = [""] * count
    if rows and len(rows[-1]) == count and _holds_units(rows):
        units = rows.pop()
    names = rows[-1] if rows and len(rows[-1]) == count else [""] * count
    for place, field in enumerate(names):
        parts = _UNIT_AT_END.match(field[:LONGEST_NAME])
        if parts and parts[1] and not units[place]:
            names[place], units[place] = parts[1], parts[2]
    return [name or str(place) for place, name in enumerate(names, start=1)], units


def _holds_units(rows: list[list[str]]) -> bool:
    """Return whether the last row holds units."""
    last = [field for field in rows[-1] if field not in ("", "-")]
    if all(_BRACKETED.match(field) for field in last):
        return True
    named = len(rows) > 1 and len(rows[-2]) == len(rows[-1])
    return named and all(find_dimension(field.strip("[]() ")) for field in last)
