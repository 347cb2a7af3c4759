"""Read HAWC2 output: a .sel file that lists the channels, and a .dat file with their numbers.

Line 9 of the .sel file holds the number of scans, the number of channels, the duration in s, and
ASCII or BINARY. From line 13 on there is one line per channel: its name in columns 13 to 43, its
unit in columns 44 to 54, then a description. Binary values are little-endian int16: all scans of
the first channel, then all of the second, and so on. The .sel file lists the factors by which the
channels are to be multiplied, below the line "Scale factors".
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.io.reading import read_bytes, require_regular
from owtsweep.motion.recorded.formats.table import ChannelTable, number_repeats
from owtsweep.motion.recorded.formats.text import read_columns
from owtsweep.motion.recorded.formats.text_layout import Layout

SUMMARY_LINE = 8
FIRST_CHANNEL = 12
#: Most bytes of a .sel file, which needs some 150 bytes per channel.
MOST_BYTES = 1 << 24
NAME, UNIT = slice(12, 43), slice(43, 54)


@dataclass(frozen=True)
class Selection:
    """The content of a .sel file with n channels."""

    scans: int
    names: tuple[str, ...]
    units: tuple[str, ...]  # "" where the file states none
    factors: Array | None  # (n,), of stored numbers; None if the .dat file is text
    duration: float  # of all scans, s


def find_companion(path: Path, suffix: str) -> Path | None:
    """Return the path with another extension, in lower or upper case, that exists; else None."""
    candidates = (path.with_suffix(suffix), path.with_suffix(suffix.upper()))
    return next((candidate for candidate in candidates if candidate.exists()), None)


def open_hawc2(path: Path) -> ChannelTable:
    """Open HAWC2 output, a .sel and a .dat file, given the path of one of these two files.

    Raises InputError if the other file is missing, one is not HAWC2's, or the .dat file is cut
        short.
    """
    wanted = ".dat" if path.suffix.lower() == ".sel" else ".sel"
    other = find_companion(path, wanted)
    if other is None:
        name = path.with_suffix(wanted).name
        raise InputError(f"{path}: HAWC2 output is two files; {name} is missing")
    require_regular(other)
    sel, dat = (path, other) if wanted == ".dat" else (other, path)
    selection = _read_selection(sel)
    _check_length(dat, selection)
    notes: list[str] = []
    read = partial(_read, dat, selection, notes)
    kind = "ASCII" if selection.factors is None else "binary"
    names, units = selection.names, selection.units
    return ChannelTable(path, f"HAWC2, {kind}", names, units, read, selection.scans, notes)


def _read_selection(sel: Path) -> Selection:
    lines = read_bytes(sel, MOST_BYTES).decode("latin-1").splitlines()
    strange = InputError(
        f"{sel}: is not a HAWC2 .sel file (line 9 holds scans, channels, time, ASCII/BINARY)"
    )
    try:
        words = lines[SUMMARY_LINE].split()
        scans, count, duration, kind = int(words[0]), int(words[1]), float(words[2]), words[3]
    except (IndexError, ValueError):
        raise strange from None
    rows = lines[FIRST_CHANNEL : FIRST_CHANNEL + count]
    possible = scans > 0 and count > 0 and 0.0 < duration < math.inf
    if len(rows) != count or kind.upper() not in ("ASCII", "BINARY") or not possible:
        raise strange
    names = number_repeats([row[NAME].strip() or str(place + 1) for place, row in enumerate(rows)])
    units = (row[UNIT].strip() for row in rows)
    stated = tuple("" if unit == "-" else unit for unit in units)
    factors = None
    if kind.upper() == "BINARY":
        below = lines[FIRST_CHANNEL + count :]
        start = next((k for k, t in enumerate(below) if "scale factor" in t.lower()), len(below))
        try:
            factors = np.array([float(n) for n in " ".join(below[start + 1 :]).split()][:count])
        except ValueError:
            raise strange from None
        if len(factors) != count:
            raise InputError(f"{sel}: has {len(factors)} scale factors for {count} channels")
    return Selection(scans, names, stated, factors, duration)


def _check_length(dat: Path, selection: Selection) -> None:
    there, channels = dat.stat().st_size, len(selection.names)
    needed = 2 * selection.scans * channels
    require(there > 0, f"{dat}: is empty")
    require(
        selection.factors is None or there >= needed,
        f"{dat}: is cut short: {selection.scans} scans of {channels} channels need {needed} bytes, "
        f"{there} are there",
    )


def _read(
    dat: Path, selection: Selection, notes: list[str], places: Sequence[int], rows: int
) -> list[Array]:
    scans = min(rows, selection.scans)
    if selection.factors is not None:
        packed = np.memmap(dat, "<i2", "r", shape=(len(selection.names), selection.scans))
        found = [packed[place, :scans] * selection.factors[place] for place in places]
    else:
        layout = Layout(" ", 0, selection.names, selection.units, ".", {})
        found = read_columns(dat, layout, notes, places, scans)
        there = min(map(len, found), default=scans)
        counted = f"{selection.scans} scans announced, {there} there"
        require(there >= scans, f"{dat}: is cut short: {counted}")
    return [_restore_time(values, k, selection) for k, values in zip(places, found, strict=True)]


def _restore_time(values: Array, place: int, selection: Selection) -> Array:
    """Return a channel's values; of the first, rounded times are replaced by uniform ones."""
    if place > 0 or not selection.names[0].lower().startswith("time") or not len(values):
        return values
    step = selection.duration / selection.scans
    comb = step * np.arange(len(values))
    comb += np.mean(values - comb)
    packing = 0.0 if selection.factors is None else float(abs(selection.factors[0]))
    rounding = max(packing, 1e-5 * float(np.max(np.abs(values))))
    return comb if np.max(np.abs(values - comb)) <= rounding else values
