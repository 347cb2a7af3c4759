"""Read FAST and OpenFAST binary output (.outb), file kinds 1 to 4.

The layout, little-endian and without padding (OpenFAST, NWTC library, subroutine WrBinFAST):

    int16    kind: 1 with time; 2 without time; 3 without time, uncompressed; 4 like kind 2,
             but the next number says how long names are
    int16    length of each name and unit (stored only in kind 4; other kinds have length 10)
    int32    number of channels besides time; int32 number of time steps
    float64  scale and offset of time (kind 1), or first time and time step in s (other kinds)
    float32  scales, then float32 offsets of the channels (not kind 3)
    int32    length of the description, then its characters
    chars    names of time and the channels, then their units
    int32    packed time of every step (kind 1)
    int16    packed values (float64 in kind 3), the channels of one step together

In kinds 1, 2 and 4 a value is (packed - offset) / scale. The times of kind 1 are computed likewise.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.motion.recorded.formats.table import ChannelTable, refuse_damaged

WITH_TIME, WITHOUT_TIME, UNCOMPRESSED, LONG_NAMES = 1, 2, 3, 4
SHORT = 10  # characters of a name in kinds 1 to 3


@dataclass(frozen=True)
class Header:
    """The header of a file with n channels besides time."""

    kind: int
    steps: int
    clock: tuple[float, float]  # of kind 1 scale and offset of time; else first time and step, s
    scale: Array  # (n,): a value is (packed - offset) / scale
    offset: Array
    names: list[str]  # of time and the channels
    units: list[str]
    first: int  # the byte at which the numbers begin


def open_fast_binary(path: Path) -> ChannelTable:
    """Open a FAST binary file (.outb); raises InputError if it is none, or is cut short."""
    header = _read_header(path)
    read = partial(_read, path, header)
    return ChannelTable(path, "FAST binary", header.names, header.units, read, header.steps)


def _read_header(path: Path) -> Header:
    size = path.stat().st_size
    not_fast = "is not a FAST binary file (.outb), or is cut short in its header"
    with refuse_damaged(path, not_fast, struct.error, ValueError), path.open("rb") as file:

        def take(code: str) -> tuple[Any, ...]:
            return struct.unpack("<" + code, file.read(struct.calcsize("<" + code)))

        def words(count: int, length: int) -> list[str]:
            if not 0 <= count * length <= size:
                raise ValueError(f"texts of {count * length} bytes")
            return [_decode(word) for word in take(f"{length}s" * count)]

        (kind,) = take("h")
        length = take("h")[0] if kind == LONG_NAMES else SHORT
        channels, steps = take("ii")
        possible = min(channels, steps, length) > 0 and max(2 * channels, steps) <= size
        if kind not in (WITH_TIME, WITHOUT_TIME, UNCOMPRESSED, LONG_NAMES) or not possible:
            raise ValueError(f"kind {kind}, {channels} channels, {steps} time steps")
        clock = take("dd")
        scale, offset = np.ones(channels), np.zeros(channels)
        if kind != UNCOMPRESSED:
            scale = np.array(take(f"{channels}f"))
            offset = np.array(take(f"{channels}f"))
        words(1, take("i")[0])  # the description
        names, units = words(channels + 1, length), words(channels + 1, length)
        first = file.tell()
        if not (np.all(np.isfinite(scale)) and np.all(scale != 0) and all(np.isfinite(clock))):
            raise ValueError("a scale that is 0 or not finite")
    per_step = channels * (8 if kind == UNCOMPRESSED else 2) + (4 if kind == WITH_TIME else 0)
    whole = (size - first) // per_step
    require(whole >= steps, f"{path}: is cut short: {steps} time steps announced, {whole} there")
    return Header(kind, steps, clock, scale, offset, names, units, first)


def _read(path: Path, header: Header, places: Sequence[int], rows: int) -> list[Array]:
    steps = min(rows, header.steps)
    start = header.first + (4 * header.steps if header.kind == WITH_TIME else 0)
    kind = "<f8" if header.kind == UNCOMPRESSED else "<i2"
    packed = np.memmap(path, kind, "r", start, (header.steps, len(header.scale)))

    def read(place: int) -> Array:
        if place > 0:
            values = packed[:steps, place - 1].astype(float)
            return np.asarray((values - header.offset[place - 1]) / header.scale[place - 1])
        if header.kind == WITH_TIME:
            ticks = np.fromfile(path, dtype="<i4", count=steps, offset=header.first)
            return np.asarray((ticks - header.clock[1]) / header.clock[0])
        return np.asarray(header.clock[0] + header.clock[1] * np.arange(steps))

    return [read(place) for place in places]


def _decode(raw: bytes) -> str:
    try:
        return raw.decode("utf-8").strip("\0 ")
    except UnicodeDecodeError:
        return raw.decode("latin-1").strip("\0 ")
