"""A file of channels, opened: its names and units are known, its numbers are read on demand."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from owtsweep.arrays import Array
from owtsweep.errors import InputError

#: `(names, rows) -> name -> (n,) float64`; `rows` bounds how many are read, None reads all.
Load = Callable[[Sequence[str], int | None], Mapping[str, Array]]


@dataclass(frozen=True)
class Table:
    """One opened file.

    Attributes
    ----------
    path
        The file.
    format
        What it is, in words.
    names
        Channel names as the file has them, without their units; time is one of them.
    units
        Unit of each channel as the file states it, "" where it does not.
    load
        Reads the named channels in the file's own units, NaN where a value is missing.
    """

    path: Path
    format: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    load: Load

    def unit(self, name: str) -> str:
        """Unit that the file states for a channel, "" for none."""
        return self.units[self.names.index(name)]


def distinct(names: Sequence[str]) -> tuple[str, ...]:
    """The same names, a repeated one numbered: `a, a` becomes `a, a (2)`."""
    seen: dict[str, int] = {}
    result = []
    for name in names:
        seen[name] = seen.get(name, 0) + 1
        result.append(name if seen[name] == 1 else f"{name} ({seen[name]})")
    return tuple(result)


def refuse(path: Path, reason: str) -> InputError:
    """The error of a file: its name, then the reason."""
    return InputError(f"{path}: {reason}")
