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
    """The channels of one opened file.

    Attributes
    ----------
    path
        The file.
    format
        The format of the file in words.
    names
        Channel names as in the file, without units; time is one of them.
    units
        Unit of each channel as in the file; "" if the file states none.
    load
        A function. load(names, rows) returns name -> values of the named channels, in the file's
        units: the first `rows` values, or all if `rows` is None. Missing values are NaN.
    rows
        The number of rows that the file announces; None if it announces none, as text does.
    notes
        Sentences for the user on what was left out. `load` adds to this list.
    """

    path: Path
    format: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    load: Load
    rows: int | None = None
    notes: list[str] = field(default_factory=list)

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
    """Return a copy of a table with printable names and units, and with limits to its size.

    The copy's `load` raises `InputError` if it would load more than `MOST_VALUES` numbers.

    Raises
    ------
    InputError
        If the table has more than `MOST_CHANNELS` channels.
    """
    if len(table.names) > MOST_CHANNELS:
        many = len(table.names)
        raise refuse(table.path, f"has {many} channels; at most {MOST_CHANNELS} are read")
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


def require_room(path: Path, rows: int, channels: int, whole: int | None = None) -> None:
    """Raise `InputError` if `rows` times `channels` numbers are more than `MOST_VALUES`.

    The message names the file `path` and `whole`, the number of all rows of the file. If `whole` is
    None, this number is not known.
    """
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
    """Return a name or a unit as printable text.

    If the text is longer than `LONGEST_NAME` characters, it is cut there and "..." is added.
    """
    text = printable(text)
    return text if len(text) <= LONGEST_NAME else f"{text[:LONGEST_NAME]}..."


def shorten(error: Exception, length: int = 120) -> str:
    """Return an error's message as one line of at most `length` characters."""
    return " ".join(str(error).split())[:length]


@contextmanager
def refuse_damaged(path: Path, what: str, *errors: type[Exception]) -> Iterator[None]:
    """Turn errors about a damaged file, raised inside a `with` block, into an `InputError`.

    Its message says of the file `what`, e.g. "is damaged", and the error's own message.
    """
    try:
        yield
    except InputError:
        raise
    except errors as error:
        raise refuse(path, f"{what} ({shorten(error)})") from None


def refuse(path: Path, reason: str) -> InputError:
    """Return (not raise) the error for a file; its message is the file's path, then the reason."""
    return InputError(f"{path}: {reason}")
