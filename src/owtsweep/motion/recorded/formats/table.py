"""The opened file of channels: names and units have been read, numbers are read on demand."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from owtsweep.arrays import Array
from owtsweep.errors import InputError

#: `load(names, rows)` reads channels: name -> values, shape (n,), float64. It reads at most `rows`
#: rows, or all if `rows` is None.
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
        Channel names as in the file, without units; time is one of the channels.
    units
        Unit of each channel as in the file; "" if the file states none.
    load
        Function that reads the named channels, in the file's units; missing values are NaN.
    """

    path: Path
    format: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    load: Load

    def unit(self, name: str) -> str:
        """Return the unit that the file states for a channel; "" if the file states none."""
        return self.units[self.names.index(name)]


def number_repeats(names: Sequence[str]) -> tuple[str, ...]:
    """Return the names with repetitions numbered: `a, a` becomes `a, a (2)`."""
    seen: dict[str, int] = {}
    result = []
    for name in names:
        seen[name] = seen.get(name, 0) + 1
        result.append(name if seen[name] == 1 else f"{name} ({seen[name]})")
    return tuple(result)


def shorten(error: Exception, length: int = 120) -> str:
    """Return an error's message as one line of at most `length` characters."""
    return " ".join(str(error).split())[:length]


def refuse(path: Path, reason: str) -> InputError:
    """Make the error to raise for a file; the message is the file's path, then the reason."""
    return InputError(f"{path}: {reason}")
