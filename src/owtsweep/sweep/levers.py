"""What could be changed about a study's sensors to lessen the errors: the levers of an advice."""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from typing import Any, NamedTuple


class Lever(NamedTuple):
    """A change of one key that may lessen the errors.

    words: what is done, e.g. "half the noise of a fix".
    key: of the configuration, or a config group; `grid.` and the name of an axis for the one value
        that this axis has.
    change: Returns the new value of the key's value; None: there is nothing to change.
    near: factors of the key's value that are tried in this order where the new one is refused: a
        rate must fit another one, a delay its steps.
    """

    words: str
    key: str
    change: Callable[[Any], Any]
    near: tuple[float, ...] = ()


def halve(value: float | None) -> float | None:
    """Return half of a value; None if it is zero or not set."""
    return value / 2.0 if value else None


def halve_whole(value: float | None) -> float | None:
    """Return half of a whole number, rounded down; None if it is zero or not set."""
    return float(int(value) // 2) if value else None


def halve_logarithm(factor: float) -> float | None:
    """Return the root of a factor on a true value; None if it is one already."""
    return sqrt(factor) if factor != 1.0 else None


def double(value: float | None) -> float | None:
    """Return twice a value; None if it is zero or not set."""
    return 2.0 * value if value else None
