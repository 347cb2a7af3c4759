"""Describe a file: its channels, their units, rates and gaps, and which roles they would get."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from textwrap import wrap

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, printable
from owtsweep.motion.recorded.checks import check_extent, check_time, describe_gaps, find_gaps
from owtsweep.motion.recorded.choosing import choose_channels
from owtsweep.motion.recorded.columns import PARTS, QUANTITIES, ROLES, find_factors, imply_unit
from owtsweep.motion.recorded.composing import Hub, compose, find_extent
from owtsweep.motion.recorded.formats import open_table
from owtsweep.motion.recorded.formats.table import MOST_VALUES, ChannelTable
from owtsweep.motion.recorded.recording import fit_comb
from owtsweep.motion.recorded.units import DIMENSIONS, find_dimension, find_factor

#: Of a longer file only this many rows are read, and fewer if it has more than 200 channels.
MOST_ROWS = 1_000_000
#: Width of the printed lists, characters, and the most channels that may be motion or force.
WIDTH, MOST_LIKELY = 100, 30


def tell_alone(*files: str) -> str:
    """Say which recorded motion an answer is for: records, or draws, differ in noise alone."""
    names = [printable(Path(file).name) for file in files]
    which = f"this motion of {names[0]}" if len(names) == 1 else f"these {len(names)} motions"
    return f"{which} alone, with noise drawn anew"


def describe(
    path: str | Path,
    *,
    columns: Mapping[str, str | None] | None = None,
    units: Mapping[str, str | None] | None = None,
    motion: str = "auto",
    tower_height: float | None = None,
    rotation: str = "zyx",
) -> str:
    """Describe every channel of a file, from its first million rows; arguments as of `read`.

    Returns lines for the terminal.

    Raises InputError if the file cannot be read at all, or a given role, channel or unit is wrong.
    """
    table = open_table(path)
    most = min(MOST_ROWS, MOST_VALUES // max(len(table.names), 1))
    loaded = _load(table, table.names, most)
    if not loaded:
        table.load(table.names, most)  # says why
    hub = Hub(motion, tower_height, rotation)
    choice = choose_channels(table, columns or {}, hub)
    table = _with_units(table, choice.roles, units or {})
    mapping = {role: name for role, name in choice.roles.items() if name in loaded}
    clock, time = _describe_clock(table, mapping.get("time"), loaded)
    rows = max(map(len, loaded.values()), default=0)
    moved = choice.problem or choice.note
    if parts := {role: name for role, name in mapping.items() if role in PARTS}:
        moved = _describe_parts(table, parts, loaded, hub)
    counted = f"{rows} rows" + (" looked at, the first of more" if rows >= most else "")
    shown = printable(str(table.path))
    lines = [f"{shown}: {table.format}, {len(table.names)} channels, {counted}", clock]
    lines += [f"note: {note}" for note in dict.fromkeys(table.notes)]
    told = partial(_describe_values, table, loaded, time)
    title = "No channel has a well-known name: set columns.time=... and others."
    if mapping:
        title = "Guess of the mapping (change one by columns.ROLE=CHANNEL):"
    width = max(map(len, mapping.values()), default=0)
    lines += ["", title]
    lines += [f"  {r:<17} = {name:<{width}}  {told(name, r)}" for r, name in mapping.items()]
    if moved:
        lines += ["", *wrap(f"What moved: {moved}", WIDTH, break_on_hyphens=False)]
    others = [name for name in table.names if name not in mapping.values()]
    likely = [name for name in others if _is_likely(table.unit(name), loaded.get(name))]
    if likely:
        lines += ["", "Others that could be motion or force, by their unit:"]
        width = max(map(len, likely[:MOST_LIKELY]))
        lines += [f"  {name:<{width}}  {told(name)}" for name in likely[:MOST_LIKELY]]
        lines += _list_names(table, likely[MOST_LIKELY:])
    if rest := [name for name in others if name not in likely]:
        lines += ["", "The rest:", *_list_names(table, rest)]
    return "\n".join(lines)


def _describe_parts(
    table: ChannelTable, names: Mapping[str, str], loaded: Mapping[str, Array], hub: Hub
) -> str:
    try:
        factors = find_factors(table, names, ROLES, {}, "units.ROLE")
        values = {role: (factors[role] or 1.0) * loaded[name] for role, name in names.items()}
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


def _describe_clock(
    table: ChannelTable, name: str | None, loaded: Mapping[str, Array]
) -> tuple[str, Array | None]:
    """Return the file's times in words, and in s, shape (n,), if they can be used."""
    if name is None:
        return "no time column found: set columns.time=CHANNEL", None
    try:
        factor = find_factors(table, {"time": name}, ROLES, {}, "units.ROLE")["time"]
        time = (factor or 1.0) * loaded[name]
        check_time(table.path, name, time, fewest=2)
        check_extent(f"{table.path}: time ({name})", time)
    except InputError as error:
        return str(error).removeprefix(f"{table.path}: "), None
    comb = fit_comb(time)
    regular = "regular" if comb.uniform else f"irregular (up to {comb.jitter:.3g} s off)"
    if comb.rounded:
        regular += f" but for rounding to {comb.resolution:g} s"
    span = f"time ({name}): {time[0]:.6g} s to {time[-1]:.6g} s, every {comb.step:.6g} s"
    return f"{span} ({1 / comb.step:.6g} Hz), {regular}", time


def _is_likely(unit: str, values: Array | None) -> bool:
    if values is None or find_extent(values) == 0.0:
        return False
    return not unit or find_dimension(unit) in QUANTITIES.values()


def _describe_values(
    table: ChannelTable,
    loaded: Mapping[str, Array],
    time: Array | None,
    name: str,
    role: str = "",
) -> str:
    unit, values = table.unit(name) or "no unit", loaded[name]
    if role and not table.unit(name):
        unit = f"{imply_unit(role, name) or DIMENSIONS[ROLES[role]][0]}?"
    there = np.isfinite(values)
    kept = values[there]
    if len(kept) == 0:
        return f"{unit}, no value at all"
    if role == "time":
        return f"{unit}, {kept.min():.6g} to {kept.max():.6g}"
    with np.errstate(over="ignore"):  # some hold 1e308, as a sign that a value is missing
        mean, deviation = kept.mean(), kept.std()
    text = f"{unit}, {kept.min():.4g} to {kept.max():.4g}, mean {mean:.4g}, "
    text += f"deviation {deviation:.3g}"
    at: Array = np.empty(0)
    if time is not None and len(time) == len(values):  # arrays may differ in length
        at = time[there]
    if len(at) > 1:
        text += f", {1.0 / float(np.median(np.diff(at))):.4g} Hz"
    if missing := len(values) - len(kept):
        text += f", {missing} missing"
    if len(at) > 1 and (gaps := find_gaps(at, 10.0)):
        text += f", {len(gaps)} gap(s): {describe_gaps(gaps, 2)}"
    return text


def _list_names(table: ChannelTable, names: Sequence[str]) -> list[str]:
    """Return names and units in lines of at most `WIDTH` characters, broken between names."""
    words = [f"{name} ({unit})" if (unit := table.unit(name)) else name for name in names]
    text = ", ".join(word.replace(" ", "\0") for word in words)
    lines = wrap(
        text, WIDTH, initial_indent="  ", subsequent_indent="  ", break_long_words=False,
        break_on_hyphens=False,
    )  # fmt: skip
    return [line.replace("\0", " ") for line in lines]
