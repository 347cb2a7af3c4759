"""The section `grid` of a configuration: its axes, and how many records a cell of the map gets.

An axis is a list of values, where an entry may be a range of numbers. The axis `[{log: [0.05, 10,
5]}, 20]` has five logarithmically spaced numbers from 0.05 to 10, and then 20. The entry `{linear:
[1, 3, 5]}` is five equally spaced numbers from 1 to 3. Ranges are replaced by their numbers when a
configuration is read, so config.yaml stores numbers.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Literal, TypeVar

from pydantic import AfterValidator, BeforeValidator, Field
from pydantic.fields import FieldInfo

from owtsweep.config.section import Positive, Section, key, list_marks
from owtsweep.statistics.deciding import FIRST, LOOKS, MARGIN, MOST

ENTRY = "{log: [first, last, count]} or {linear: [first, last, count]}"
#: A range with more points than this is refused as a typing error.
MOST_POINTS = 1_000_000
#: Significant digits of the numbers between the ends of a range: 0.3 instead of
#: 0.30000000000000004. So a range gives the same block keys on every machine, and the same keys as
#: a list of these numbers.
DIGITS = 12

T = TypeVar("T")


def expand(values: object) -> object:
    """Replace each range in a list, e.g. `{log: [0.05, 10, 5]}`, by its numbers.

    Raise `ValueError` if a range is impossible, or the new list has more than `MOST_POINTS`
    entries.
    """
    if not isinstance(values, list):
        return values
    numbers: list[object] = []
    for entry in values:
        numbers += _numbers(entry) if isinstance(entry, Mapping) else [entry]
        if len(numbers) > MOST_POINTS:
            raise ValueError(f"it has more than {MOST_POINTS} values; give fewer")
    return numbers


def require_distinct(values: list[T]) -> list[T]:
    """Return `values` unchanged; raise `ValueError` if the list contains a value twice."""
    if len(set(values)) < len(values):
        raise ValueError("a value stands there twice; list it once")
    return values


#: The type of an axis: a list that is not empty and contains no value twice.
Axis = Annotated[
    list[T], Field(min_length=1), BeforeValidator(expand), AfterValidator(require_distinct)
]


def is_axis(field: FieldInfo) -> bool:
    """Return whether a key's type is an `Axis`, or an `Axis` or null."""
    marks = list_marks(field)
    return any(isinstance(mark, BeforeValidator) and mark.func is expand for mark in marks)


def _numbers(entry: Mapping[str, Sequence[float]]) -> list[float]:
    """Return the numbers of one range; the ends are exact, the others have `DIGITS` digits.

    Raise `ValueError` if the range is impossible; the caller puts the axis's key before the
    message.
    """
    shown = ", ".join(f"{spacing}: {ends}" for spacing, ends in entry.items())
    try:
        ((spacing, (first, last, count)),) = entry.items()
        if spacing not in ("log", "linear") or bool in (type(first), type(last), type(count)):
            raise ValueError
        first, last, points = float(first), float(last), int(count)
        if points != count:
            raise ValueError
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{{{shown}}} is no entry of an axis; use a number, {ENTRY}") from None
    if not 2 <= points <= MOST_POINTS:
        raise ValueError(f"{{{shown}}} has a count of {points}; give 2 to {MOST_POINTS}")
    if not (math.isfinite(first) and math.isfinite(last)):
        raise ValueError(f"{{{shown}}} needs finite ends")
    if first >= last:
        raise ValueError(f"{{{shown}}} does not rise; give the lower end first")
    if spacing == "linear":
        step = (last - first) / (points - 1)
        between = [first + i * step for i in range(1, points - 1)]
    elif first <= 0.0:
        raise ValueError(f"{{{shown}}} must begin above zero; use linear, or another first value")
    else:
        ratio = last / first
        between = [first * ratio ** (i / (points - 1)) for i in range(1, points - 1)]
    return [first, *(float(f"{number:.{DIGITS}g}") for number in between), last]


#: Most records of a cell in a fixed design.
MOST_RECORDS = 1_000_000
_FIRST_LOOKS = f"{', '.join(map(str, LOOKS[:7]))}, ..."


def _read_count(value: object) -> object:
    if value == "auto":
        return value
    whole = int(value) if isinstance(value, float) and value.is_integer() else value
    try:
        count = int(str(whole))
    except ValueError:
        raise ValueError(f"{value!r} is neither a whole number nor auto") from None
    if count < 1:
        raise ValueError(f"{value} must be at least 1")
    if count > MOST_RECORDS:
        raise ValueError(f"{value} is more than {MOST_RECORDS}; lower it")
    return count


def _require_look(most: int) -> int:
    if most not in LOOKS:
        raise ValueError(
            f"{most} is not the number of records of a look; use one of {_FIRST_LOOKS}"
        )
    return most


class Records(Section):
    """The keys of the section `grid` of every study, besides those of its axes."""

    replicates: Annotated[int | Literal["auto"], BeforeValidator(_read_count)] = key(
        "records per cell, each with random numbers of its own; auto: until the cell is decided"
    )
    margin: Positive = key(
        "with auto: the difference of two errors that does not matter, as a part of the error",
        default=MARGIN,
        le=1,
    )
    most: Annotated[int, AfterValidator(_require_look)] = key(
        f"with auto: most records per cell, one of {_FIRST_LOOKS}", default=MOST
    )
    budget: Positive | None = key(
        "with auto: after this time no further look begins; the same command goes on", unit="s",
        default=None,
    )  # fmt: skip

    @property
    def decides(self) -> bool:
        """Whether cells get records until they are decided."""
        return self.replicates == "auto"

    @property
    def first(self) -> int:
        """Number of records that every cell gets."""
        return FIRST if self.replicates == "auto" else self.replicates

    @property
    def greatest(self) -> int:
        """Most records that a cell may get."""
        return self.most if self.replicates == "auto" else self.replicates

    def count_records(self) -> str:
        """Return in words how many records a cell has, e.g. "20" or "8 to 256"."""
        return " to ".join(dict.fromkeys((str(self.first), str(self.greatest))))

    def describe_records(self) -> str:
        """Return in words that a cell has so many records."""
        until = ", until it is decided" * (self.greatest > self.first)
        return f"{self.count_records()} record{'s' * (self.replicates != 1)} per cell{until}"


#: Keys of `grid` that say how a contest goes on, not what it is over.
CONTEST_KEYS = frozenset(Records.model_fields) - {"replicates"}
