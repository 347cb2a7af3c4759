"""Read NMEA 0183: the positions of GGA sentences, as the channels of a table."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.io.reading import read_bytes
from owtsweep.motion.recorded.formats.table import ChannelTable, shorten

FORMAT = "NMEA, GGA sentences"
#: Channels of the table with their units. The height is above the ellipsoid; where no sentence
#: states the geoid's separation, there is an altitude above the geoid in its place.
CHANNELS = {"time": "s", "latitude": "deg", "longitude": "deg", "height": "m", "gga_quality": ""}
PLACE = ("latitude", "longitude", "height")
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
    rows, separated = _read_sentences(path)
    require(bool(rows), f"{path}: no GGA sentence has a fix")
    require(
        len(separated) == 1,
        f"{path}: some GGA sentences have a geoid separation and others have none, so heights "
        "jump; keep one kind",
    )
    table = np.array(rows, dtype=float)
    clock = table[:, 0]
    clock += DAY * np.cumsum(np.diff(clock, prepend=clock[0]) < -0.5 * DAY)
    names = [name if name != "height" or True in separated else "altitude" for name in CHANNELS]

    def read(places: Sequence[int], count: int) -> list[Array]:
        return [table[:count, place] for place in places]

    units = tuple(CHANNELS.values())
    return ChannelTable(path, FORMAT, tuple(names), units, read, len(table))


def _read_sentences(path: Path) -> tuple[list[tuple[float, ...]], set[bool]]:
    try:
        from pynmeagps import ERR_RAISE, NMEAReader
        from pynmeagps.exceptions import (
            NMEAMessageError,
            NMEAParseError,
            NMEAStreamError,
            NMEATypeError,
        )
    except ModuleNotFoundError:
        raise InputError(
            f"{path}: NMEA needs the package pynmeagps; install the extra: pip install "
            "'owtsweep[gnss]'"
        ) from None
    rows: list[tuple[float, ...]] = []
    separated = set()
    try:
        for _, said in NMEAReader(BytesIO(read_bytes(path, MOST_BYTES)), quitonerror=ERR_RAISE):
            if said is None or not said.identity.endswith("GGA"):
                continue
            stated = vars(said)  # of a sentence that is cut, not all
            quality = stated.get("quality", "")
            if quality == NO_FIX:
                continue
            require(
                quality == "" or quality in QUALITIES,
                f"{path}: GGA sentence {len(rows) + 1} has the quality {quality}, and NMEA has 0 "
                f"to {QUALITIES[-1]}; cut damaged sentences out",
            )
            apart, altitude = stated.get("sep", ""), stated.get("alt", "")
            separated.add(apart != "")
            height = "" if altitude == "" else altitude + (apart or 0.0)
            place = (stated.get("lat", ""), stated.get("lon", ""), height)
            at = stated.get("time", "")
            found = {"time": at, "quality": quality, **dict(zip(PLACE, place, strict=True))}
            wrong = [name for name, value in found.items() if value in ("", None)]
            wrong += [name for name in PLACE if found[name] != found[name]]
            require(
                not wrong,
                f"{path}: GGA sentence {len(rows) + 1} with a fix has no readable "
                f"{' and no readable '.join(wrong)}; cut damaged sentences out",
            )
            second = 3600.0 * at.hour + 60.0 * at.minute + at.second + 1e-6 * at.microsecond
            rows.append((second, *map(float, place), quality))
    except (NMEAMessageError, NMEAParseError, NMEAStreamError, NMEATypeError) as error:
        raise InputError(
            f"{path}: sentence {len(rows) + 1} cannot be read ({shorten(error)}); cut damaged "
            "sentences out"
        ) from None
    return rows, separated
