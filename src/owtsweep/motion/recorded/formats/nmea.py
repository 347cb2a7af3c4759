"""Read NMEA 0183: the positions of GGA sentences, as the channels of a table."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.io.reading import read_bytes
from owtsweep.motion.recorded.formats.table import ChannelTable, shorten

FORMAT = "NMEA, GGA sentences"
#: Channels of the table with their units. The height is above the ellipsoid; where no sentence
#: states the geoid's separation, there is an altitude above the geoid in its place.
CHANNELS = {"time": "s", "latitude": "deg", "longitude": "deg", "height": "m", "gga_quality": ""}
#: Qualities of a fix: those that there are, and no fix.
QUALITIES, NO_FIX = range(10), 0
#: Largest file, bytes; seconds of a day.
MOST_BYTES, DAY = 200_000_000, 86_400.0


def open_nmea(path: Path) -> ChannelTable:
    """Open a file of NMEA sentences: the channels `CHANNELS` of GGA sentences with a fix.

    Times are seconds of the first day.

    Raises InputError without the package pynmeagps, if no sentence has a fix, a sentence cannot be
        read or lacks a number, or some state a geoid separation and others do not.
    """
    fixes: list[list[float]] = []
    separated = set()
    for number, fields in enumerate(_read_sentences(path), start=1):
        fixes.append(_read_fix(f"{path}: GGA sentence {number}", fields))
        separated.add(fields.get("sep", "") != "")
    require(bool(fixes), f"{path}: no GGA sentence has a fix")
    require(
        len(separated) == 1,
        f"{path}: some GGA sentences have a geoid separation and others have none, so heights "
        "jump; keep one kind",
    )
    table = np.array(fixes)
    clock = table[:, 0]
    clock += DAY * np.cumsum(np.diff(clock, prepend=clock[0]) < -0.5 * DAY)
    names = [name if name != "height" or True in separated else "altitude" for name in CHANNELS]

    def read(places: Sequence[int], count: int) -> list[Array]:
        return [table[:count, place].copy() for place in places]

    return ChannelTable(path, FORMAT, names, [*CHANNELS.values()], read, len(table))


def _read_sentences(path: Path) -> Iterator[Mapping[str, Any]]:
    """Yield the fields of the GGA sentences with a fix; of a sentence that is cut, not all."""
    try:
        from pynmeagps import ERR_RAISE, NMEAReader
        from pynmeagps import exceptions as wrong
    except ModuleNotFoundError:
        raise InputError(
            f"{path}: NMEA needs the package pynmeagps; install the extra: pip install "
            "'owtsweep[gnss]'"
        ) from None
    count = 0
    try:
        for _, said in NMEAReader(BytesIO(read_bytes(path, MOST_BYTES)), quitonerror=ERR_RAISE):
            is_position = said is not None and said.identity.endswith("GGA")
            if is_position and vars(said).get("quality", "") != NO_FIX:
                count += 1
                yield vars(said)
    except (
        wrong.NMEAMessageError, wrong.NMEAParseError, wrong.NMEAStreamError, wrong.NMEATypeError
    ) as error:  # fmt: skip
        raise InputError(
            f"{path}: sentence {count + 1} cannot be read ({shorten(error)}); cut damaged "
            "sentences out"
        ) from None


def _read_fix(where: str, fields: Mapping[str, Any]) -> list[float]:
    """Return the numbers of a sentence in the order of `CHANNELS`."""
    names = ("time", "lat", "lon", "alt", "quality")
    at, latitude, longitude, height, quality = (fields.get(name, "") for name in names)
    require(
        quality == "" or quality in QUALITIES,
        f"{where} has the quality {quality}, and NMEA has 0 to {QUALITIES[-1]}; cut damaged "
        "sentences out",
    )
    if height != "":
        height += fields.get("sep", "") or 0.0
    found = (at, latitude, longitude, height, quality)
    wrong = [
        name.removeprefix("gga_")
        for name, value in zip(CHANNELS, found, strict=True)
        if value in ("", None) or value != value
    ]
    require(
        not wrong,
        f"{where} with a fix has no readable {' and no readable '.join(wrong)}; cut damaged "
        "sentences out",
    )
    second = 3600.0 * at.hour + 60.0 * at.minute + at.second + 1e-6 * at.microsecond
    return [second, *map(float, found[1:])]
