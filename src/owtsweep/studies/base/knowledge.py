"""What a scheme is told beforehand, as a value that can be compared with another."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import fields, is_dataclass

import numpy as np

from owtsweep.config import Section


class Knowledge:
    """The base class of what a study tells its schemes: a frozen dataclass with `eq=False`.

    Two are equal if all their numbers are, those of arrays bit for bit. So a scheme is prepared
    once for all records about which it is told the same.
    """

    def __eq__(self, other: object) -> bool:
        """Return whether both are of one class and hold the same numbers."""
        return identify(self) == identify(other)

    def __hash__(self) -> int:
        """Return a hash of all numbers."""
        return hash(identify(self))


def identify(value: object) -> Hashable:
    """Return what is equal for equal values: arrays, dataclasses, sections, tuples, scalars."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, Section):
        return type(value), identify(list(vars(value).values()))
    if is_dataclass(value):
        return type(value), *(identify(getattr(value, field.name)) for field in fields(value))
    if isinstance(value, (list, tuple)):
        return tuple(identify(item) for item in value)
    return value if isinstance(value, (bool, int, float, str)) else repr(value)
