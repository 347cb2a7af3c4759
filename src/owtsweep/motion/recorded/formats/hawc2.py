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
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.io.reading import read_bytes, require_regular
from owtsweep.motion.recorded.formats.table import ChannelTable, refuse_damaged
from owtsweep.motion.recorded.formats.text import read_columns
from owtsweep.motion.recorded.formats.text_layout import Layout

SUMMARY_LINE = 8
FIRST_CHANNEL = 12
#: Most bytes of a .sel file, which needs some 150 bytes per channel.
MOST_BYTES = 1 << 24
NAME, UNIT = slice(12, 43), slice(43, 54)


class Selection(NamedTuple):
    """The content of a .sel file with n channels."""

    scans: int
    names: list[str]
    units: list[str]
    factors: Array | None  # (n,), of stored numbers; None if the .dat file is text
    duration: float  # of all scans, s


def find_companion(path: Path, suffix: str) -> Path | None:
    """Return the path with another extension, in lower or upper case, that exists; else None."""
    candidates = (path.with_suffix(suffix), path.with_suffix(suffix.upper()))
    return next((candidate for candidate in candidates if candidate.exists()), None)


def open_hawc2(path: Path) -> ChannelTable:
    """Open HAWC2 output, a .sel and a .dat file, given the path of one of these two files.

    Raises InputError if the other file is missing, or one is not HAWC2's; when numbers are loaded,
        if the .dat file is cut short.
    """
    wanted = ".dat" if path.suffix.lower() == ".sel" else ".sel"
    other = find_companion(path, wanted)
    if other is None:
        name = path.with_suffix(wanted).name
        raise InputError(f"{path}: HAWC2 output is two files; {name} is missing")
    require_regular(other)
    sel, dat = (path, other) if wanted == ".dat" else (other, path)
    found = _read_selection(sel)
    notes: list[str] = []
    read = partial(_read, dat, found, notes)
    kind = "HAWC2, ASCII" if found.factors is None else "HAWC2, binary"
    return ChannelTable(path, kind, found.names, found.units, read, found.scans, notes)


def _read_selection(sel: Path) -> Selection:
    lines = read_bytes(sel, MOST_BYTES).decode("latin-1").splitlines()
    strange = "is not a HAWC2 .sel file, whose line 9 holds scans, channels, time, ASCII/BINARY"
    factors = None
    with refuse_damaged(sel, strange, IndexError, ValueError):
        words = lines[SUMMARY_LINE].split()
        scans, count, duration, kind = int(words[0]), int(words[1]), float(words[2]), words[3]
        rows, below = lines[FIRST_CHANNEL:][:count], lines[FIRST_CHANNEL + count :]
        if kind.upper() == "BINARY":
            start = next(
                (k for k, t in enumerate(below) if "scale factor" in t.lower()), len(below)
            )
            factors = np.array(" ".join(below[start + 1 :]).split()[:count], dtype=float)
        elif kind.upper() != "ASCII":
            raise ValueError(kind)
        if scans < 1 or not 0 < count == len(rows) or not 0.0 < duration < math.inf:
            raise ValueError(f"{len(rows)} lines of channels")
    if factors is not None and len(factors) != count:
        raise InputError(f"{sel}: has {len(factors)} scale factors for {count} channels")
    names, units = [row[NAME].strip() for row in rows], [row[UNIT] for row in rows]
    return Selection(scans, names, units, factors, duration)


def _read(
    dat: Path, selection: Selection, notes: list[str], places: Sequence[int], rows: int
) -> list[Array]:
    scans, count = selection.scans, len(selection.names)
    short = f"is cut short: {scans} scans of {count} channels are announced"
    if selection.factors is not None:
        there, needed = dat.stat().st_size, 2 * scans * count
        require(there >= needed, f"{dat}: {short}, of {needed} bytes {there} are there")
        with refuse_damaged(dat, short, ValueError):
            packed = np.memmap(dat, "<i2", "r", shape=(count, scans))
        found = [packed[place, :rows] * selection.factors[place] for place in places]
    else:
        layout = Layout(" ", 0, selection.names, selection.units, ".", {})
        found = read_columns(dat, layout, notes, places, min(rows, scans))
        require(len(found[0]) >= min(rows, scans), f"{dat}: {short}, {len(found[0])} are there")
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
