"""Defines the table of an opened file: names and units are known, numbers are read on demand."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

from owtsweep.arrays import Array
from owtsweep.errors import InputError, printable, require

#: At most this many numbers of 8 bytes are read from a file: rows times channels that are used.
MOST_VALUES = 200_000_000
#: A regular grid of times (of the record, or of the IMU) has at most this many steps. A replay
#: needs some 160 bytes per step.
MOST_STEPS = 50_000_000
MOST_CHANNELS = 10_000
#: Names and units of channels are cut to this many characters.
LONGEST_NAME = 200
#: `read(places, rows)` returns the columns at some places, each a float64 array of shape (n,). The
#: number n of rows is at most `rows`.
Read = Callable[[Sequence[int], int], Sequence[Array]]


@dataclass(frozen=True)
class ChannelTable:
    """The channels of one opened file."""

    path: Path
    format: str  # in words
    names: Sequence[str]  # without units; time is one of them
    units: Sequence[str]  # "" where the file states none
    read: Read  # numbers in the file's units, NaN where missing
    rows: int | None = None  # as the file announces; text announces none
    notes: list[str] = field(default_factory=list)  # what `read` left out

    def tidied(self) -> ChannelTable:
        """Return the table with printable names, none empty or twice, and bare units."""
        names = [tidy(name) or str(place) for place, name in enumerate(self.names, start=1)]
        units = [tidy(unit.strip("()[] ")) for unit in self.units]
        units = ["" if unit in ("-", "none") else unit for unit in units]
        return replace(self, names=number_repeats(names), units=tuple(units))

    def unit(self, name: str) -> str:
        """Return the unit that the file states for a channel; "" if the file states none."""
        return self.units[self.names.index(name)]

    def load(self, names: Sequence[str], rows: int | None = None) -> dict[str, Array]:
        """Return name -> numbers in the file's units, NaN where missing; at most `rows` of each.

        Raises InputError if there are more than `MOST_VALUES` numbers, or the file is damaged.
        """
        one_too_many = MOST_VALUES // max(len(names), 1) + 1
        most = one_too_many if rows is None else min(rows, one_too_many)
        if self.rows is not None:
            require_room(self.path, min(self.rows, most), len(names), self.rows)
        columns = self.read([self.names.index(name) for name in names], most)
        for values in columns:
            require_room(self.path, len(values), len(names))
        return dict(zip(names, columns, strict=True))


def number_repeats(names: Sequence[str]) -> tuple[str, ...]:
    """Return the names, repeated names being numbered: `a, a` becomes `a, a (2)`."""
    numbers: dict[str, int] = {}
    for name in names:
        unique = name
        while unique in numbers:
            numbers[name] += 1
            unique = f"{name} ({numbers[name]})"
        numbers[unique] = 1
    return tuple(numbers)


def require_channels(path: Path, count: int) -> None:
    """Raise `InputError` if a file announces more than `MOST_CHANNELS` channels."""
    require(
        count <= MOST_CHANNELS, f"{path}: has {count} channels; at most {MOST_CHANNELS} are read"
    )


def require_room(path: Path, rows: int, channels: int, whole: int | None = None) -> None:
    """Raise `InputError` for more than `MOST_VALUES` numbers; `whole`: all rows, if known."""
    many = f"{rows - 1} rows or more" if whole is None else f"{whole} rows"
    size = 8e-9 * channels * (whole or rows)
    require(
        rows * channels <= MOST_VALUES,
        f"{path}: {many} of {channels} channels need {size:.3g} GB; at most "
        f"{8e-9 * MOST_VALUES:g} GB are read: cut the record into parts, or use fewer channels",
    )


def tidy(text: str) -> str:
    """Return a name or a unit as printable text of at most `LONGEST_NAME` characters."""
    text = printable(text)
    return text if len(text) <= LONGEST_NAME else f"{text[:LONGEST_NAME]}..."


def shorten(error: Exception, length: int = 120) -> str:
    """Return an error's message as one line of at most `length` characters."""
    return " ".join(str(error).split())[:length]


@contextmanager
def refuse_damaged(path: Path | str, what: str, *errors: type[Exception]) -> Iterator[None]:
    """Turn errors inside a `with` block into an `InputError`: the file, `what`, the error."""
    try:
        yield
    except InputError:
        raise
    except errors as error:
        raise InputError(f"{path}: {what} ({shorten(error)})") from None
