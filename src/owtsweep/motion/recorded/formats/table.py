"""Defines the table of an opened file: names and units are known, numbers are read on demand."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

from owtsweep.arrays import Array
from owtsweep.errors import InputError, printable

#: At most this many numbers of 8 bytes are read from a file: rows times channels that are used.
MOST_VALUES = 200_000_000
#: A regular grid of times (of the record, or of the IMU) has at most this many steps. A replay
#: needs some 160 bytes per step.
MOST_STEPS = 50_000_000
MOST_CHANNELS = 10_000
#: Names and units of channels are cut to this many characters.
LONGEST_NAME = 200
#: `load(names, rows)` returns name -> float64 array of shape (n,). The number n of rows is at most
#: `rows`; None reads all rows.
Load = Callable[[Sequence[str], int | None], Mapping[str, Array]]


@dataclass(frozen=True)
class ChannelTable:
    """The channels of one opened file."""

    path: Path
    format: str  # in words
    names: tuple[str, ...]  # without units; time is one of them
    units: tuple[str, ...]  # "" where the file states none
    load: Load  # numbers in the file's units, NaN where missing
    rows: int | None = None  # as the file announces; text announces none
    notes: list[str] = field(default_factory=list)  # what `load` left out

    def unit(self, name: str) -> str:
        """Return the unit that the file states for a channel; "" if the file states none."""
        return self.units[self.names.index(name)]


def number_repeats(names: Sequence[str]) -> tuple[str, ...]:
    """Return the names, repeated names being numbered: `a, a` becomes `a, a (2)`."""
    seen: dict[str, int] = {}
    result = []
    for name in names:
        seen[name] = seen.get(name, 0) + 1
        result.append(name if seen[name] == 1 else f"{name} ({seen[name]})")
    return tuple(result)


def make_safe(table: ChannelTable) -> ChannelTable:
    """Return a copy with printable names and units, which loads at most `MOST_VALUES` numbers."""
    require_channels(table.path, len(table.names))
    names = number_repeats([tidy(name) for name in table.names])
    raw = dict(zip(names, table.names, strict=True))

    def load(wanted: Sequence[str], rows: int | None) -> Mapping[str, Array]:
        one_too_many = MOST_VALUES // max(len(wanted), 1) + 1
        rows = one_too_many if rows is None else min(rows, one_too_many)
        if table.rows is not None:
            require_room(table.path, min(table.rows, rows), len(wanted), table.rows)
        loaded = table.load([raw[name] for name in wanted], rows)
        for values in loaded.values():
            require_room(table.path, len(values), len(wanted))
        return {name: loaded[raw[name]] for name in wanted}

    return replace(table, names=names, units=tuple(map(tidy, table.units)), load=load)


def require_channels(path: Path, count: int) -> None:
    """Raise `InputError` if a file announces more than `MOST_CHANNELS` channels."""
    if count > MOST_CHANNELS:
        raise refuse(path, f"has {count} channels; at most {MOST_CHANNELS} are read")


def require_room(path: Path, rows: int, channels: int, whole: int | None = None) -> None:
    """Raise `InputError` for more than `MOST_VALUES` numbers; `whole`: all rows, if known."""
    if rows * channels <= MOST_VALUES:
        return
    many = f"{rows - 1} rows or more" if whole is None else f"{whole} rows"
    size = 8e-9 * channels * (whole or rows)
    raise refuse(
        path,
        f"{many} of {channels} channels need {size:.3g} GB; at most {8e-9 * MOST_VALUES:g} GB are "
        "read: cut the record into parts, or use fewer channels",
    )


def tidy(text: str) -> str:
    """Return a name or a unit as printable text of at most `LONGEST_NAME` characters."""
    text = printable(text)
    return text if len(text) <= LONGEST_NAME else f"{text[:LONGEST_NAME]}..."


def shorten(error: Exception, length: int = 120) -> str:
    """Return an error's message as one line of at most `length` characters."""
    return " ".join(str(error).split())[:length]


@contextmanager
def refuse_damaged(path: Path, what: str, *errors: type[Exception]) -> Iterator[None]:
    """Turn errors inside a `with` block into an `InputError`: the file, `what`, the error."""
    try:
        yield
    except InputError:
        raise
    except errors as error:
        raise refuse(path, f"{what} ({shorten(error)})") from None


def refuse(path: Path, reason: str) -> InputError:
    """Return (not raise) the error for a file."""
    return InputError(f"{path}: {reason}")
