"""What is in a file: channels, units, rates, gaps, and a guess of the mapping."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.motion.recorded.checks import gaps, say_gaps
from owtsweep.motion.recorded.columns import ROLES, guess
from owtsweep.motion.recorded.formats import Table, open_table
from owtsweep.motion.recorded.timing import timing
from owtsweep.motion.recorded.units import DIMENSIONS, canonical, dimension

#: Longer files are described by their first rows.
MOST_ROWS = 1_000_000
#: Text width of the lists.
WIDTH = 100


@dataclass(frozen=True)
class Channel:
    """One channel, in the file's own unit.

    Attributes
    ----------
    name, unit
        As in the file; unit "" where it says none.
    missing
        How many rows have no value.
    mean, deviation, smallest, largest
        NaN where there is no value.
    rate
        Hz, from the median interval between its values; NaN without time.
    gaps
        (start, end) in s of intervals longer than ten sampling intervals (0.1 s at least).
    numeric
        False for a column that is not read as numbers.
    """

    name: str
    unit: str
    missing: int
    mean: float
    deviation: float
    smallest: float
    largest: float
    rate: float
    gaps: tuple[tuple[float, float], ...]
    numeric: bool = True


@dataclass(frozen=True)
class Description:
    """What is in a file; `str()` of it is the text for the terminal.

    Attributes
    ----------
    path, format
        The file and what it is.
    rows
        How many were looked at; `cut` says that there may be more.
    guess
        role -> channel that `read` takes by default.
    channels
        All of them, in the file's order.
    clock
        One line on the times.
    """

    path: Path
    format: str
    rows: int
    cut: bool
    guess: dict[str, str]
    channels: tuple[Channel, ...]
    clock: str

    def __str__(self) -> str:
        rows = f"{self.rows} rows" + (" looked at, the first of more" if self.cut else "")
        lines = [f"{self.path}: {self.format}, {len(self.channels)} channels, {rows}", self.clock]
        known = {channel.name: channel for channel in self.channels}
        if self.guess:
            lines += ["", "Guess of the mapping (change one by columns.ROLE=CHANNEL):"]
            width = max(len(name) for name in self.guess.values())
            for role, name in self.guess.items():
                lines.append(f"  {role:<17} = {name:<{width}}  {_facts(known[name], role)}")
        else:
            lines += ["", "No channel has a well-known name: set columns.time=... and others."]
        played = set(self.guess.values())
        likely = [c for c in self.channels if c.name not in played and _likely(c)]
        rest = [c for c in self.channels if c.name not in played and not _likely(c)]
        if likely:
            lines += ["", "Others that could be motion or force, by their unit:"]
            width = max(len(channel.name) for channel in likely[:30])
            lines += [f"  {c.name:<{width}}  {_facts(c)}" for c in likely[:30]]
            if len(likely) > 30:
                lines += _wrapped([f"{c.name} ({c.unit})" for c in likely[30:]])
        if rest:
            lines += ["", "The rest:"]
            lines += _wrapped([f"{c.name} ({c.unit})" if c.unit else c.name for c in rest])
        return "\n".join(lines)


def describe(path: str | Path) -> Description:
    """Look at every channel of a file (the first million rows of a longer one).

    Raises
    ------
    InputError
        If the file cannot be read at all.
    """
    table = open_table(path)
    loaded = _load(table)
    mapping = guess(table.names)
    mapping = {role: name for role, name in mapping.items() if loaded.get(name) is not None}
    time: Array | None = None
    clock = "no time column found: set columns.time=CHANNEL"
    if "time" in mapping:
        name = mapping["time"]
        factor = DIMENSIONS["time"][1].get(canonical(table.unit(name) or "s"), 1.0)
        values = loaded[name]
        assert values is not None
        time = values * factor
        clock = _clock(name, time)
        if len(time) < 2 or not np.all(np.diff(time) > 0.0):
            time = None
    lengths = [len(values) for values in loaded.values() if values is not None]
    rows = max(lengths, default=0)
    channels = tuple(
        _channel(name, unit, loaded.get(name), time)
        for name, unit in zip(table.names, table.units, strict=True)
    )
    return Description(table.path, table.format, rows, rows >= MOST_ROWS, mapping, channels, clock)


def _load(table: Table) -> dict[str, Array | None]:
    """All channels; None for a column that is not numbers."""
    try:
        return dict(table.load(table.names, MOST_ROWS))
    except InputError:
        loaded: dict[str, Array | None] = {}
        for name in table.names:
            try:
                loaded[name] = table.load([name], MOST_ROWS)[name]
            except InputError:
                loaded[name] = None
        if all(values is None for values in loaded.values()):
            raise
        return loaded


def _clock(name: str, time: Array) -> str:
    if len(time) < 2 or not np.all(np.isfinite(time)):
        return f"time ({name}) has missing values or fewer than two"
    step = np.diff(time)
    if step.min() <= 0.0:
        row = int(np.argmin(step > 0.0)) + 2
        return f"time ({name}) does not increase in data row {row}"
    comb = timing(time)
    regular = (
        "regular" + (f" but for rounding to {comb.resolution:g} s" if comb.rounded else "")
        if comb.uniform
        else f"irregular (up to {comb.jitter:.3g} s off)"
    )
    return (
        f"time ({name}): {time[0]:.6g} s to {time[-1]:.6g} s, every {comb.step:.6g} s "
        f"({1 / comb.step:.6g} Hz), {regular}"
    )


def _channel(name: str, unit: str, values: Array | None, time: Array | None) -> Channel:
    nan = float("nan")
    if values is None:
        return Channel(name, unit, 0, nan, nan, nan, nan, nan, (), numeric=False)
    there = np.isfinite(values)
    kept = values[there]
    if len(kept) == 0:
        return Channel(name, unit, len(values), nan, nan, nan, nan, nan, ())
    rate = nan
    holes: tuple[tuple[float, float], ...] = ()
    if time is not None and len(kept) > 1:
        median = float(np.median(np.diff(time[there])))
        rate, holes = 1.0 / median, tuple(gaps(time[there], max(0.1, 10 * median)))
    return Channel(
        name,
        unit,
        int(len(values) - len(kept)),
        float(kept.mean()),
        float(kept.std()),
        float(kept.min()),
        float(kept.max()),
        rate,
        holes,
    )


def _likely(channel: Channel) -> bool:
    """Whether its unit is one of motion or force, or it has none, and it moves at all."""
    if not channel.numeric or not channel.deviation > 0.0:
        return False
    return not channel.unit or dimension(channel.unit) in ("length", "velocity", "acceleration")


def _facts(channel: Channel, role: str | None = None) -> str:
    unit = channel.unit
    if not unit:
        unit = f"{DIMENSIONS[ROLES[role]][0]}?" if role else "no unit"
    if np.isnan(channel.mean):
        return f"{unit}, no value at all"
    parts = [
        f"{unit}, {channel.smallest:.4g} to {channel.largest:.4g}, mean {channel.mean:.4g}, "
        f"deviation {channel.deviation:.3g}"
    ]
    if role != "time":
        if not np.isnan(channel.rate):
            parts.append(f"{channel.rate:.4g} Hz")
        if channel.missing:
            parts.append(f"{channel.missing} missing")
        if channel.gaps:
            parts.append(f"{len(channel.gaps)} gap(s): {say_gaps(list(channel.gaps), 2)}")
        return ", ".join(parts)
    return f"{unit}, {channel.smallest:.6g} to {channel.largest:.6g}"


def _wrapped(words: list[str]) -> list[str]:
    from textwrap import wrap

    text = ", ".join(word.replace(" ", "\0") for word in words)
    return [
        line.replace("\0", " ")
        for line in wrap(
            text,
            WIDTH,
            initial_indent="  ",
            subsequent_indent="  ",
            break_long_words=False,
            break_on_hyphens=False,
        )
    ]
