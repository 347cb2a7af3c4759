"""Read the named signals of a study's file, in SI units, at the file's times or at uniform ones.

A study says which signals it knows. The configuration renames columns and states units by items
SIGNAL:NAME or SIGNAL:NAME:UNIT. (A hub's file has roles in place of signals: `reading.read`.)
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.motion.recorded import checks
from owtsweep.motion.recorded.columns import (
    TIME_NAMES,
    find,
    find_channel,
    find_factors,
    list_names,
    refuse_without_time,
    to_si,
)
from owtsweep.motion.recorded.formats import open_table
from owtsweep.motion.recorded.formats.table import ChannelTable
from owtsweep.motion.recorded.gridding import fill
from owtsweep.motion.recorded.recording import describe_jitter, fit_comb

logger = logging.getLogger(__name__)

#: Rows that are nearer than this part of a step count as repeated.
NEAREST = 0.1
#: By how much the file's step may differ from the study's.
OTHER_STEP = 1e-3


@dataclass(frozen=True)
class Wanted:
    """The signals that a kind of file may have, besides time."""

    key: str  # the key of the configuration with the items, e.g. "recorded.columns"; "" if none
    dimension: Callable[[str], str | None]  # of `units.DIMENSIONS`; None if there is no such signal
    listed: str  # the signals in words
    needed: tuple[str, ...] = ()  # without these a file is refused

    def knows(self, signal: str) -> bool:
        """Return whether a file may have a signal; time is one."""
        return signal == "time" or self.dimension(signal) is not None

    def tell_name(self, signal: str) -> str:
        """Say how to name the column of a signal."""
        return f"set {self.key}=[{signal}:NAME]" if self.key else f"call its column {signal}"


@dataclass(frozen=True)
class Signals:
    """The signals of a file."""

    path: Path
    time: Array  # s, shape (n,)
    step: float  # between two samples, s; NaN if times are not uniform
    values: Mapping[str, Array]  # in SI units, shape (n,)
    columns: Mapping[str, str]  # signal, or "time" -> the column's name
    unused: tuple[str, ...]  # the other columns
    notes: tuple[str, ...]  # what was left out, or resampled

    def stack(self, names: Sequence[str]) -> Array:
        """Return some signals as columns, shape (n, names)."""
        return np.column_stack([self.values[name] for name in names])

    def log_notes(self) -> None:
        """Log the notes as warnings."""
        for note in self.notes:
            logger.warning("%s: %s", self.path, note)

    def require_record(self, rate: float, steps: int, begin: int = 0) -> None:
        """Raise `InputError` if the file has not a record's rate (Hz), or ends before its steps."""
        require(
            abs(self.step * rate - 1.0) <= OTHER_STEP,
            f"record.rate: {rate:g} Hz, but {self.path} has a row every {self.step:g} s; set "
            f"record.rate={1.0 / self.step:.6g}",
        )
        length = np.floor(100.0 * (len(self.time) - begin) / rate + 1e-6) / 100.0
        require(
            begin + steps <= len(self.time),
            f"record.duration: {steps / rate:g} s, but {self.path} lasts {length:g} s"
            f"{' from the first fix on' if begin else ''}; set record.duration={length:.10g}",
        )


def read_signals(
    path: str | Path,
    wanted: Wanted,
    items: Sequence[str] = (),
    others: Sequence[tuple[ChannelTable, Wanted]] = (),
) -> Signals:
    """Read the signals of a file at uniform times, those of the file or near them.

    If times jitter, or rows up to `WIDEST` steps apart are missing, signals are resampled, with a
    note.

    path, wanted: the file, and the signals that it may have.
    items: the value of the key `wanted.key`.
    others: further files that the items are for.
    Raises InputError if the file cannot be read, a column, a unit or a number is missing or wrong,
        times do not rise, or rows are too far apart or too near each other.
    """
    table = open_table(path)
    _check_items(items, [(table, wanted), *others])
    found = _load_signals(table, wanted, items)
    checks.check_time(found.path, found.columns["time"], found.time)
    for signal, values in found.values.items():
        missing = checks.describe_missing(f"{signal} (channel {found.columns[signal]})", values)
        require(not missing, f"{found.path}: {missing}; fill the gaps or cut the record there")
    return _make_uniform(found)


def read_fixes(table: ChannelTable, wanted: Wanted, items: Sequence[str]) -> Signals:
    """Read the rows of an opened file in which no needed signal is missing; times may be uneven.

    Errors are those of `read_signals`; items are not checked, for they may be for other files.
    """
    found = _load_signals(table, wanted, items)
    there = np.isfinite(found.stack(wanted.needed)).all(axis=1)
    require(bool(there.any()), f"{table.path}: no row has a position")
    rows = np.flatnonzero(there)
    time = found.time[rows]
    checks.check_time(table.path, found.columns["time"], time, rows=rows, fewest=2)
    kept = {signal: values[rows] for signal, values in found.values.items()}
    return replace(found, time=time, values=kept)


def _check_items(items: Sequence[str], files: Sequence[tuple[ChannelTable, Wanted]]) -> None:
    for item in items:
        signal, _, rest = item.partition(":")
        key = files[0][1].key
        known = [table for table, wanted in files if wanted.knows(signal)]
        require(
            bool(known) and bool(rest.strip()),
            f"{key}: {item!r} is not SIGNAL:NAME or SIGNAL:NAME:UNIT; signals are time, "
            f"{', '.join(dict.fromkeys(wanted.listed for _, wanted in files))}",
        )
        if not any(_find(table, wanted, item) for table, wanted in files):
            find_channel(known[0], rest.split(":")[0].strip(), f"{key}={item}")  # says which are


def _load_signals(table: ChannelTable, wanted: Wanted, items: Sequence[str]) -> Signals:
    columns, units = _find_columns(table, wanted, items)
    loaded = table.load(list(dict.fromkeys(columns.values())))
    dimensions = {s: "time" if s == "time" else str(wanted.dimension(s)) for s in columns}
    setting = f"{wanted.key}=[ROLE:NAME:UNIT]" if wanted.key else "brackets behind its name"
    factors = find_factors(table, columns, dimensions, units, setting)
    values = to_si(loaded, columns, factors)
    time = values.pop("time")
    for signal, each in values.items():
        checks.require_possible(
            f"{table.path}: {signal} (channel {columns[signal]})",
            each,
            "check its unit, and mend or cut out damaged rows",
            load=dimensions[signal] in ("force", "moment"),
        )
    unused = tuple(name for name in table.names if name not in columns.values())
    notes = tuple(dict.fromkeys(table.notes))
    return Signals(table.path, time, float("nan"), values, columns, unused, notes)


def _find(table: ChannelTable, wanted: Wanted, item: str) -> tuple[str, str] | None:
    """Return the channel and the unit that an item names; None if it names none of the file."""
    signal, _, rest = item.partition(":")
    name, _, unit = rest.rpartition(":")
    for each, given in ((rest, ""), (name, unit)):  # a name may hold a colon
        if each.strip() and wanted.knows(signal):
            with suppress(InputError):
                return find_channel(table, each.strip(), ""), given.strip()
    return None


def _find_columns(
    table: ChannelTable, wanted: Wanted, items: Sequence[str]
) -> tuple[dict[str, str], dict[str, str]]:
    columns: dict[str, str] = {}
    units: dict[str, str] = {}
    for item in items:
        signal = item.partition(":")[0]
        if place := _find(table, wanted, item):
            require(
                signal not in columns,
                f"{wanted.key}: {signal} is there twice for columns of {table.path}; leave one out",
            )
            columns[signal], units[signal] = place
    taken = set(columns.values())
    if "time" not in columns:
        clock = find([name for name in table.names if name not in taken], *TIME_NAMES)
        if clock is None:
            raise refuse_without_time(table, wanted.tell_name("time"))
        columns["time"] = clock
    for name in table.names:
        if name not in {*taken, columns["time"]} and wanted.knows(name):
            columns.setdefault(name, name)
    missing = [signal for signal in wanted.needed if signal not in columns]
    require(
        not missing,
        f"{table.path}: no column {' and no column '.join(missing[:3])}; it has "
        f"{list_names(table)}; {wanted.tell_name(''.join(missing[:1]))}",
    )
    return columns, units


def _make_uniform(found: Signals) -> Signals:
    time, where = found.time, f"{found.path}: time ({found.columns['time']})"
    checks.check_extent(where, time)
    even = fit_comb(time, np.arange(len(time), dtype=float))  # much jitter looks like missing rows
    comb = min(even, fit_comb(time), key=lambda each: each.jitter)
    if comb.uniform and comb.count == len(time):
        return replace(found, step=comb.step)
    checks.refuse_gaps(where, time, 0.0)
    between = np.diff(time)
    row = int(np.argmin(between))
    require(
        between[row] >= NEAREST * comb.step,
        f"{where} nearly stands still in data row {row + 2}: {between[row]:.3g} s after the row "
        f"before, elsewhere {np.median(between):.6g} s; drop repeated times",
    )
    filled = f"{comb.count - len(time)} rows are missing: filled by cubic spline"
    note = filled if comb.uniform else describe_jitter(comb, float(np.median(between)))
    beyond = comb.teeth - np.clip(comb.teeth, time[0], time[-1])
    kept = comb.uniform | (np.abs(beyond) <= 0.5 * comb.step)
    return replace(
        found,
        time=comb.teeth[kept],
        step=comb.step,
        values={signal: fill(time, each, comb)[kept] for signal, each in found.values.items()},
        notes=(*found.notes, note),
    )
