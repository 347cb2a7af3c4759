"""Describe a file: its channels, their units, rates and gaps, and which roles they would get."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from textwrap import wrap

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, printable
from owtsweep.motion.recorded.checks import (
    check_extent,
    check_time,
    describe_gaps,
    find_gaps,
)
from owtsweep.motion.recorded.choosing import add_motion
from owtsweep.motion.recorded.columns import PARTS, QUANTITIES, ROLES, assign_roles
from owtsweep.motion.recorded.composing import Hub, compose, imply_unit
from owtsweep.motion.recorded.formats import open_table
from owtsweep.motion.recorded.formats.table import MOST_VALUES, ChannelTable
from owtsweep.motion.recorded.reading import find_factors
from owtsweep.motion.recorded.recording import fit_comb
from owtsweep.motion.recorded.units import DIMENSIONS, find_dimension, find_factor, normalise_unit

#: Of a longer file only this many rows are read, and fewer if it has more than 200 channels.
MOST_ROWS = 1_000_000
#: Width of the printed lists, characters.
WIDTH = 100


def tell_alone(*files: str) -> str:
    """Say which recorded motion an answer is for: records, or draws, differ in noise alone."""
    names = [printable(Path(file).name) for file in files]
    which = f"this motion of {names[0]}" if len(names) == 1 else f"these {len(names)} motions"
    return f"{which} alone, with noise drawn anew"


@dataclass(frozen=True)
class Channel:
    """One channel of a file, in the unit that the file uses; NaN where there is no number."""

    name: str
    unit: str  # "" if the file states none
    missing: int = 0  # rows
    mean: float = np.nan
    deviation: float = np.nan
    smallest: float = np.nan
    largest: float = np.nan
    rate: float = np.nan  # Hz, from the median interval
    gaps: tuple[tuple[float, float], ...] = ()  # (start, end) in s, longer than 0.1 s and ten steps
    numeric: bool = True


@dataclass(frozen=True)
class Description:
    """The contents of a file in summary; `str(description)` is the text for the terminal."""

    path: Path
    format: str  # in words
    rows: int  # that were read
    cut: bool  # whether there may be more
    guess: dict[str, str]  # role -> the channel that would be taken
    channels: tuple[Channel, ...]
    clock: str  # a sentence about the times
    motion: str = ""  # how the hub's motion is composed, or why it cannot be
    notes: tuple[str, ...] = ()  # what was left out

    def __str__(self) -> str:
        rows = f"{self.rows} rows" + (" looked at, the first of more" if self.cut else "")
        path = printable(str(self.path))
        lines = [f"{path}: {self.format}, {len(self.channels)} channels, {rows}", self.clock]
        lines += [f"note: {note}" for note in self.notes]
        by_name = {channel.name: channel for channel in self.channels}
        if self.guess:
            lines += ["", "Guess of the mapping (change one by columns.ROLE=CHANNEL):"]
            width = max(map(len, self.guess.values()))
            for role, name in self.guess.items():
                values = _describe_values(by_name[name], role)
                lines.append(f"  {role:<17} = {name:<{width}}  {values}")
        else:
            lines += ["", "No channel has a well-known name: set columns.time=... and others."]
        if self.motion:
            lines += ["", *wrap(f"What moved: {self.motion}", WIDTH, break_on_hyphens=False)]
        others = [c for c in self.channels if c.name not in self.guess.values()]
        if likely := [c for c in others if _is_likely(c)]:
            lines += ["", "Others that could be motion or force, by their unit:"]
            width = max(len(channel.name) for channel in likely[:30])
            lines += [f"  {c.name:<{width}}  {_describe_values(c)}" for c in likely[:30]]
            lines += _wrap(f"{c.name} ({c.unit})" for c in likely[30:])
        if rest := [c for c in others if not _is_likely(c)]:
            lines += ["", "The rest:"]
            lines += _wrap(f"{c.name} ({c.unit})" if c.unit else c.name for c in rest)
        return "\n".join(lines)


def describe(
    path: str | Path,
    *,
    columns: Mapping[str, str | None] | None = None,
    units: Mapping[str, str | None] | None = None,
    motion: str = "auto",
    tower_height: float | None = None,
    rotation: str = "zyx",
) -> Description:
    """Describe every channel of a file, from its first million rows; arguments as of `read`.

    Raises InputError if the file cannot be read at all, or a given role, channel or unit is wrong.
    """
    table = open_table(path)
    most = min(MOST_ROWS, MOST_VALUES // max(len(table.names), 1))
    loaded = _load(table, table.names, most)
    if not loaded:
        table.load(table.names, most)  # says why
    hub = Hub(motion, tower_height, rotation)
    mapping = assign_roles(table, columns or {})
    mapping, choice = add_motion(table, mapping, columns or {}, hub)
    table = _with_units(table, mapping, units or {})
    mapping = {role: name for role, name in mapping.items() if name in loaded}
    time: Array | None = None
    clock = "no time column found: set columns.time=CHANNEL"
    if name := mapping.get("time"):
        to_seconds = DIMENSIONS["time"][1].get(normalise_unit(table.unit(name) or "s"), 1.0)
        clock = _describe_clock(table.path, name, to_seconds * loaded[name])
        if len(loaded[name]) > 1 and np.all(np.diff(loaded[name]) > 0.0):
            time = to_seconds * loaded[name]
    rows = max(map(len, loaded.values()), default=0)
    channels = tuple(
        _summarise(name, unit, loaded.get(name), time)
        for name, unit in zip(table.names, table.units, strict=True)
    )
    moved = choice.problem or choice.note
    if parts := {role: name for role, name in mapping.items() if role in PARTS}:
        moved = _describe_parts(table, parts, loaded, hub)
    notes = tuple(dict.fromkeys(table.notes))
    return Description(
        table.path, table.format, rows, rows >= most, mapping, channels, clock, moved, notes
    )


def _describe_parts(
    table: ChannelTable, names: Mapping[str, str], loaded: Mapping[str, Array], hub: Hub
) -> str:
    try:
        factors, _ = find_factors(table, names, {})
        values = {role: factors[role] * loaded[name] for role, name in names.items()}
        return compose(table.path, values, names, hub)[2]
    except InputError as error:
        return str(error).removeprefix(f"{table.path}: ")


def _with_units(
    table: ChannelTable, mapping: Mapping[str, str], units: Mapping[str, str | None]
) -> ChannelTable:
    stated = dict(zip(table.names, table.units, strict=True))
    for role, unit in units.items():
        if unit and role in mapping:
            find_factor(unit, ROLES[role], f"{table.path}: units.{role}")
            stated[mapping[role]] = unit
    return replace(table, units=tuple(stated.values()))


def _load(table: ChannelTable, names: Sequence[str], rows: int) -> Mapping[str, Array]:
    try:
        return table.load(names, rows)
    except InputError:
        if len(names) == 1:
            return {}
        half = len(names) // 2  # few reads find one column without numbers among thousands
        return {**_load(table, names[:half], rows), **_load(table, names[half:], rows)}


def _describe_clock(path: Path, name: str, time: Array) -> str:
    try:
        check_time(path, name, time, fewest=2)
        check_extent(path, f"time ({name})", time)
    except InputError as error:
        return str(error).removeprefix(f"{path}: ")
    comb = fit_comb(time)
    regular = "regular" if comb.uniform else f"irregular (up to {comb.jitter:.3g} s off)"
    if comb.rounded:
        regular += f" but for rounding to {comb.resolution:g} s"
    return (
        f"time ({name}): {time[0]:.6g} s to {time[-1]:.6g} s, every {comb.step:.6g} s "
        f"({1 / comb.step:.6g} Hz), {regular}"
    )


def _summarise(name: str, unit: str, values: Array | None, time: Array | None) -> Channel:
    if values is None:
        return Channel(name, unit, numeric=False)
    there = np.isfinite(values)
    kept, missing = values[there], int(np.count_nonzero(~there))
    if len(kept) == 0:
        return Channel(name, unit, missing)
    rate, gaps = np.nan, []
    if time is not None and len(kept) > 1:
        rate, gaps = 1.0 / float(np.median(np.diff(time[there]))), find_gaps(time[there], 10.0)
    with np.errstate(over="ignore"):  # some hold 1e308, as a sign that a value is missing
        mean, deviation = float(kept.mean()), float(kept.std())
    ends = float(kept.min()), float(kept.max())
    return Channel(name, unit, missing, mean, deviation, *ends, rate, tuple(gaps))


def _is_likely(channel: Channel) -> bool:
    if not channel.deviation > 0.0:  # NaN without numbers
        return False
    return not channel.unit or find_dimension(channel.unit) in QUANTITIES.values()


def _describe_values(channel: Channel, role: str | None = None) -> str:
    unit = channel.unit or "no unit"
    if role and not channel.unit:
        unit = f"{imply_unit(role, channel.name) or DIMENSIONS[ROLES[role]][0]}?"
    if np.isnan(channel.mean):
        return f"{unit}, no value at all"
    if role == "time":
        return f"{unit}, {channel.smallest:.6g} to {channel.largest:.6g}"
    text = (
        f"{unit}, {channel.smallest:.4g} to {channel.largest:.4g}, mean {channel.mean:.4g}, "
        f"deviation {channel.deviation:.3g}"
    )
    if not np.isnan(channel.rate):
        text += f", {channel.rate:.4g} Hz"
    if channel.missing:
        text += f", {channel.missing} missing"
    if channel.gaps:
        text += f", {len(channel.gaps)} gap(s): {describe_gaps(channel.gaps, 2)}"
    return text


def _wrap(words: Iterable[str]) -> list[str]:
    # at most `WIDTH` characters, broken only between words
    text = ", ".join(word.replace(" ", "\0") for word in words)
    lines = wrap(
        text, WIDTH, initial_indent="  ", subsequent_indent="  ", break_long_words=False,
        break_on_hyphens=False,
    )  # fmt: skip
    return [line.replace("\0", " ") for line in lines]
