"""An opened file of channels: names and units have been read, numbers are read on demand."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from owtsweep.arrays import Array
from owtsweep.errors import InputError

#: `load(names, rows)` returns name -> (n,) float64. It reads at most `rows` rows; None reads all.
Load = Callable[[Sequence[str], int | None], Mapping[str, Array]]


@dataclass(frozen=True)
class ChannelTable:
    """The channels of one opened file.

    Attributes
    ----------
    path
        The file.
    format
        The format in words.
    names
        Channel names as in the file, without units; time is one of them.
    units
        Unit of each channel as in the file; "" if the file states none.
    load
        Reads the named channels in the file's units; missing values are NaN.
    """

    path: Path
    format: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    load: Load

    def unit(self, name: str) -> str:
        """The unit that the file states for a channel; "" if it states none."""
        return self.units[self.names.index(name)]


def number_repeats(names: Sequence[str]) -> tuple[str, ...]:
    """The same names, with repeated ones numbered: `a, a` becomes `a, a (2)`."""
    seen: dict[str, int] = {}
    result = []
    for name in names:
        seen[name] = seen.get(name, 0) + 1
        result.append(name if seen[name] == 1 else f"{name} ({seen[name]})")
    return tuple(result)


def shorten(error: Exception, length: int = 120) -> str:
    """A library's message as one line of at most `length` characters."""
    return " ".join(str(error).split())[:length]


def refuse(path: Path, reason: str) -> InputError:
    """The error to raise for a file: its path, then the reason."""
    return InputError(f"{path}: {reason}")
