"""Read times with dates, as ISO 8601 writes them: 2024-05-01T12:00:00.000Z becomes seconds."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.recorded.formats.table import refuse, shorten

if TYPE_CHECKING:
    import pyarrow as pa

#: The unit of a column of such times, in place of one that the file states.
ISO_TIME = "ISO 8601"

_ZONE = r"(Z|[+-]\d\d(:?\d\d)?)"
#: Date, T or a blank, time of day, perhaps Z or the offset from UTC.
_PATTERN = r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d([.,]\d{1,9})?)?" + _ZONE + "?$"
_ISO = re.compile(_PATTERN)
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


def is_split_time(fields: list[str]) -> bool:
    """Return whether a row begins with a date and a time of day as two fields."""
    return len(fields) > 1 and bool(_DATE.match(fields[0])) and bool(_CLOCK.match(fields[1]))


class IsoTimes:
    """Converts a column of times in ISO 8601, piece by piece, to seconds from the first time.

    `example` is the first field of the column `name`. `InputError` is raised if it is in another
    form, whose meaning is not clear.
    """

    def __init__(self, path: Path, name: str, example: str) -> None:
        self._path, self._name = path, name
        self._first: int | None = None
        self._zoned: bool | None = None
        if not is_iso_time(example):
            raise refuse(
                path,
                f"column {name} holds times like {example}: write date and time in ISO 8601, e.g. "
                "2024-05-01T12:00:00.000Z, or seconds",
            )

    def convert(self, texts: pa.StringArray) -> Array:
        """Return the next times in s from the column's first; NaN where a text is missing.

        Raises InputError if a text is not in ISO 8601, or only some times have an offset from UTC.
        """
        import pandas as pd
        import pyarrow.compute as pc

        there = pc.is_valid(texts).to_numpy(zero_copy_only=False)
        good = pc.match_substring_regex(texts, "^" + _PATTERN).fill_null(True)
        if not pc.all(good).as_py():
            wrong = texts.filter(pc.invert(good))[0].as_py()
            raise refuse(
                self._path,
                f"column {self._name} holds times in ISO 8601, but also {wrong[:40]!r}",
            )
        zoned = pc.match_substring_regex(texts, _ZONE + "$").drop_null().unique().to_pylist()
        if self._zoned is None and zoned:
            self._zoned = zoned[0]
        if any(each != self._zoned for each in zoned):
            raise refuse(
                self._path,
                f"column {self._name}: some times state Z or an offset from UTC, others do not; "
                "write them in one way",
            )
        series = pc.replace_substring(texts, ",", ".").to_pandas()
        try:
            moments = pd.to_datetime(series, format="ISO8601", utc=True).dt.tz_localize(None)
        except (ValueError, OverflowError) as error:
            raise refuse(
                self._path, f"column {self._name}: no such time ({shorten(error)})"
            ) from None
        numbers = moments.to_numpy(dtype="datetime64[ns]").view(np.int64)
        if self._first is None and there.any():
            self._first = int(numbers[there][0])
        result = np.full(len(numbers), np.nan)
        result[there] = (numbers[there] - (self._first or 0)) * 1e-9
        return result
