"""Read HAWC2 output: a .sel file that lists the channels, and a .dat file with their numbers.

Line 9 of the .sel file holds the number of scans, the number of channels, the duration in s, and
ASCII or BINARY. From line 13 on there is one line per channel: its name in columns 13 to 43, its
unit in columns 44 to 54, then a description. Binary values are little-endian int16: all scans of
the first channel, then all of the second, and so on. The .sel file lists the factors by which the
channels are to be multiplied, below the line "Scale factors".
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.io.reading import read_bytes, require_regular
from owtsweep.motion.recorded.formats.streams import TextStream
from owtsweep.motion.recorded.formats.table import ChannelTable, number_repeats, refuse, shorten

SUMMARY_LINE = 8
FIRST_CHANNEL = 12
#: Most bytes of a .sel file, which needs some 150 bytes per channel.
MOST_BYTES = 1 << 24
NAME, UNIT = slice(12, 43), slice(43, 54)


@dataclass(frozen=True)
class Selection:
    """The content of a .sel file with n channels.

    Attributes
    ----------
    scans
        The number of scans, i.e. of time steps.
    names, units
        The name and the unit of each channel; a unit is "" if the file states none.
    factors
        Shape (n,), the factor by which the stored numbers of each channel are to be multiplied;
        None if the .dat file holds text, whose numbers need no factor.
    duration
        The duration of all scans, in s.
    """

    scans: int
    names: tuple[str, ...]
    units: tuple[str, ...]
    factors: Array | None
    duration: float


def find_companion(path: Path, suffix: str) -> Path | None:
    """Return `path` with its extension replaced by `suffix`, in lower or upper case.

    Return the first of these two paths that exists, or None if neither does.
    """
    candidates = (path.with_suffix(suffix), path.with_suffix(suffix.upper()))
    return next((candidate for candidate in candidates if candidate.exists()), None)


def open_hawc2(path: Path) -> ChannelTable:
    """Open HAWC2 output, a .sel and a .dat file, given the path of one of these two files.

    Raises
    ------
    InputError
        If the other file is missing, the .sel file is not HAWC2's, or the .dat file is empty or cut
        short.
    """
    wanted = ".dat" if path.suffix.lower() == ".sel" else ".sel"
    other = find_companion(path, wanted)
    if other is None:
        raise refuse(path, f"HAWC2 output is two files; {path.with_suffix(wanted).name} is missing")
    require_regular(other)
    sel, dat = (path, other) if wanted == ".dat" else (other, path)
    selection = _read_selection(sel)
    _check_length(dat, selection)
    load = partial(_load, dat, selection)
    kind = "ASCII" if selection.factors is None else "binary"
    names, units = selection.names, selection.units
    return ChannelTable(path, f"HAWC2, {kind}", names, units, load, selection.scans)


def _read_selection(sel: Path) -> Selection:
    lines = read_bytes(sel, MOST_BYTES).decode("latin-1").splitlines()
    strange = refuse(
        sel, "is not a HAWC2 .sel file (line 9 holds scans, channels, time, ASCII/BINARY)"
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
            raise refuse(sel, f"has {len(factors)} scale factors for {count} channels")
    return Selection(scans, names, stated, factors, duration)


def _check_length(dat: Path, selection: Selection) -> None:
    there = dat.stat().st_size
    needed = 2 * selection.scans * len(selection.names)
    if there == 0:
        raise refuse(dat, "is empty")
    if selection.factors is not None and there < needed:
        raise refuse(
            dat,
            f"is cut short: {selection.scans} scans of {len(selection.names)} channels need "
            f"{needed} bytes, {there} are there",
        )


def _load(
    dat: Path, selection: Selection, names: Sequence[str], rows: int | None
) -> Mapping[str, Array]:
    places = {name: selection.names.index(name) for name in names}
    if selection.factors is not None:
        shape = len(selection.names), selection.scans
        packed = np.memmap(dat, dtype="<i2", mode="r", shape=shape)
        columns = {k: packed[k, :rows] * selection.factors[k] for k in places.values()}
    else:
        columns = _load_text(dat, selection, sorted(set(places.values())), rows)
    return {name: _restore_time(columns[k], k, selection) for name, k in places.items()}


def _load_text(
    dat: Path, selection: Selection, places: list[int], rows: int | None
) -> dict[int, Array]:
    import pandas as pd

    try:
        with TextStream(dat) as stream:
            frame = pd.read_csv(
                stream, sep=r"\s+", header=None, names=range(len(selection.names)),
                usecols=places, nrows=rows, dtype="float64", encoding_errors="replace",
            )  # fmt: skip
    except InputError:
        raise
    except (ValueError, pd.errors.ParserError) as error:
        raise refuse(dat, f"cannot be read as numbers ({shorten(error, 160)})") from None
    wanted = selection.scans if rows is None else min(rows, selection.scans)
    if len(frame) < wanted:
        raise refuse(dat, f"is cut short: {selection.scans} scans announced, {len(frame)} there")
    return {k: frame[k].to_numpy(dtype=float) for k in places}


def _restore_time(values: Array, place: int, selection: Selection) -> Array:
    """Return a channel's values, and those of the time channel at full resolution.

    `values` are the values of the channel with the number `place`, from 0. Only values of the time
    channel are changed. HAWC2 stores time in 16 bits or 6 digits, so times repeat in a long file.
    Uniform times, with a step of duration / scans, replace the stored times if the two differ only
    by rounding.
    """
    if place != 0 or not selection.names[0].lower().startswith("time") or not len(values):
        return values
    step = selection.duration / selection.scans
    comb = step * np.arange(len(values))
    comb += np.mean(values - comb)
    packing = 0.0 if selection.factors is None else float(abs(selection.factors[0]))
    rounding = max(packing, 1e-5 * float(np.max(np.abs(values))))
    return comb if np.max(np.abs(values - comb)) <= rounding else values
