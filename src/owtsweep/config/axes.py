"""Axes of a grid: lists of values in the configuration, where an entry may be a range of numbers.

The axis `[{log: [0.05, 10, 5]}, 20]` has five logarithmically spaced numbers from 0.05 to 10, and
then 20. The entry `{linear: [1, 3, 5]}` is five equally spaced numbers from 1 to 3. Ranges are
replaced by their numbers when a configuration is read, so config.yaml stores numbers.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, TypeVar

from pydantic import AfterValidator, BeforeValidator, Field
from pydantic.fields import FieldInfo

from owtsweep.config.section import list_marks

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
