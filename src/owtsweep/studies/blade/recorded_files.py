"""Reads what an inertial unit and GNSS receivers recorded: tables, and NMEA sentences."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require, shorten
from owtsweep.io.reading import read_bytes
from owtsweep.motion.recorded import open_table
from owtsweep.motion.recorded.checks import require_possible
from owtsweep.motion.recorded.columns import name_signals
from owtsweep.motion.recorded.formats.table import ChannelTable
from owtsweep.motion.recorded.units import find_factor_to

FORCE, RATE = ("fx", "fy", "fz"), ("wx", "wy", "wz")
LOCAL, GLOBE = ("x", "y", "z"), ("latitude", "longitude", "height")
#: Signal -> the SI unit in which it is taken; degrees for the globe.
UNITS = {
    "time": "s",
    **dict.fromkeys(FORCE, "m/s^2"),
    **dict.fromkeys(RATE, "rad/s"),
    **dict.fromkeys((*LOCAL, "height"), "m"),
    **dict.fromkeys(("latitude", "longitude"), "deg"),
}
#: Qualities of an NMEA fix: those that there are, no fix, and a float solution.
QUALITIES, NO_FIX, FLOAT = range(10), 0, 5
#: Largest NMEA file, bytes; seconds of a day.
MOST_BYTES, DAY = 200_000_000, 86_400.0
#: What to do about an absurdly large number.
DAMAGED = "check its unit, and cut damaged rows out"
EXTRA = "install the extra: pip install 'owtsweep[gnss]'"


class Inertial(NamedTuple):
    """What an inertial unit says: times (s), specific force (m/s^2), rates (rad/s), (n, 3) each."""

    time: Array
    force: Array
    rate: Array


class Fixes(NamedTuple):
    """What an antenna says.

    Attributes
    ----------
    time
        Times in s, shape (n,).
    position
        x, y, z in m, or latitude (deg), longitude (deg) and height (m), shape (n, 3).
    globe
        Whether positions are on the globe.
    floating
        Whether a solution is float, shape (n,).
    above_geoid
        Whether heights are above the geoid, because the file does not state its separation.
    """

    time: Array
    position: Array
    globe: bool
    floating: NDArray[np.bool_]
    above_geoid: bool = False


def read_inertial(path: Path, columns: Sequence[str]) -> Inertial:
    """Read the table of an inertial unit.

    Raises
    ------
    InputError
        If the file cannot be read, a column or a number is missing, a number is absurdly large, or
        times do not increase.
    """
    table = open_table(path)
    found = _load(table, ("time", *FORCE, *RATE), columns)
    for name, values in found.items():
        missing = np.flatnonzero(~np.isfinite(values))
        require(
            len(missing) == 0,
            f"{path}: {name} has no number in data row {missing[0] + 1 if len(missing) else 0}; "
            "fill the gaps or cut the record there",
        )
        if name != "time":
            require_possible(f"{path}: {name}", values, DAMAGED)
    _check_times(path, found["time"])
    force, rate = (np.column_stack([found[name] for name in names]) for names in (FORCE, RATE))
    return Inertial(found["time"], force, rate)


def read_fixes(path: Path, columns: Sequence[str]) -> Fixes:
    """Read the positions of an antenna, from NMEA sentences (.nmea) or a table.

    Raises
    ------
    InputError
        If the file cannot be read, a column is missing, times do not increase, or a position is
        none or absurdly large.
    """
    fixes = _read_nmea(path) if path.suffix.lower() == ".nmea" else _read_table(path, columns)
    _check_times(path, fixes.time)
    for name, values in zip(GLOBE if fixes.globe else LOCAL, fixes.position.T, strict=True):
        require_possible(f"{path}: {name}", values, DAMAGED)
    if fixes.globe:
        for i, (name, most) in enumerate((("latitude", 90.0), ("longitude", 360.0))):
            wrong = np.flatnonzero(np.abs(fixes.position[:, i]) > most)
            require(
                len(wrong) == 0,
                f"{path}: a {name} of {fixes.position[wrong[:1], i].sum():g} degrees in data row "
                f"{wrong[0] + 1 if len(wrong) else 0}; give decimal degrees up to {most:g}",
            )
    return fixes


def check_columns(columns: Sequence[str], imu: Path, gnss: Sequence[Path]) -> None:
    """Check that each item of `recorded.columns` names a column of a table that has its signal.

    Raises
    ------
    InputError
        If a table cannot be read, an item cannot be one, or no such table has its column.
    """
    if not columns:
        return
    unit = [open_table(imu)]
    antennas = [open_table(path) for path in gnss if path.suffix.lower() != ".nmea"]
    for item in columns:
        signal, *words = item.split(":")
        require(
            signal in UNITS and len(words) in (1, 2),
            f"recorded.columns: {item!r} is not SIGNAL:NAME or SIGNAL:NAME:UNIT; signals are "
            f"{', '.join(UNITS)}",
        )
        asked = unit if signal in (*FORCE, *RATE) else antennas
        if signal == "time":
            asked = [*unit, *antennas]
        there = "; ".join(f"{t.path} has {shorten(', '.join(t.names), 200)}" for t in asked)
        require(
            any(words[0] in table.names for table in asked),
            f"recorded.columns: {item!r}, but there is no column {words[0]!r} for {signal}; "
            f"{there or 'NMEA sentences have no columns'}",
        )


def _read_table(path: Path, columns: Sequence[str]) -> Fixes:
    table = open_table(path)
    named = {item.partition(":")[0] for item in columns}
    globe = "latitude" in (*table.names, *named) and "x" not in table.names
    names = GLOBE if globe else LOCAL
    found = _load(table, ("time", *names), columns)
    position = np.column_stack([found[name] for name in names])
    there = np.isfinite(position).all(axis=1)
    require(bool(there.any()), f"{path}: no row has a position")
    return Fixes(found["time"][there], position[there], globe, np.zeros(there.sum(), dtype=bool))


def _read_nmea(path: Path) -> Fixes:
    """Read GGA sentences: times are seconds of the first day, heights are above the ellipsoid.

    Where the geoid's separation is empty, the height is the altitude: only differences of heights
    matter here. So it must be empty in all sentences or in none.
    """
    try:
        from pynmeagps import ERR_RAISE, NMEAReader
        from pynmeagps.exceptions import (
            NMEAMessageError,
            NMEAParseError,
            NMEAStreamError,
            NMEATypeError,
        )
    except ModuleNotFoundError:
        raise InputError(f"{path}: NMEA needs the package pynmeagps; {EXTRA}") from None
    from io import BytesIO

    rows: list[tuple[object, ...]] = []
    separated = set()
    try:
        for _, said in NMEAReader(BytesIO(read_bytes(path, MOST_BYTES)), quitonerror=ERR_RAISE):
            if said is None or not said.identity.endswith("GGA"):
                continue
            told = vars(said)  # of a sentence that is cut, not all
            quality = told.get("quality", "")
            if quality == NO_FIX:
                continue
            require(
                quality == "" or quality in QUALITIES,
                f"{path}: GGA sentence {len(rows) + 1} has the quality {quality}, and NMEA has 0 "
                f"to {QUALITIES[-1]}; cut damaged sentences out",
            )
            apart = told.get("sep", "")
            separated.add(apart != "")
            altitude = told.get("alt", "")
            height = "" if altitude == "" else altitude + (apart or 0.0)
            at = told.get("time", "")
            place = (told.get("lat", ""), told.get("lon", ""), height)
            found = {"time": at, "quality": quality, **dict(zip(GLOBE, place, strict=True))}
            wrong = [name for name, value in found.items() if value in ("", None)]
            wrong += [name for name in GLOBE if found[name] != found[name]]
            require(
                not wrong,
                f"{path}: GGA sentence {len(rows) + 1} with a fix has no readable "
                f"{' and no readable '.join(wrong)}; cut damaged sentences out",
            )
            second = 3600.0 * at.hour + 60.0 * at.minute + at.second + 1e-6 * at.microsecond
            rows.append((second, *place, quality == FLOAT))
    except (NMEAMessageError, NMEAParseError, NMEAStreamError, NMEATypeError) as error:
        raise InputError(
            f"{path}: sentence {len(rows) + 1} cannot be read ({shorten(str(error), 120)}); cut "
            "damaged sentences out"
        ) from None
    require(bool(rows), f"{path}: no GGA sentence has a fix")
    require(
        len(separated) == 1,
        f"{path}: some GGA sentences have a geoid separation and others have none, so heights "
        "jump; keep one kind",
    )
    table = np.array(rows, dtype=float)
    time = table[:, 0] + DAY * np.cumsum(np.diff(table[:, 0], prepend=table[0, 0]) < -0.5 * DAY)
    return Fixes(time, table[:, 1:4], True, table[:, 4] > 0.0, separated == {False})


def _load(table: ChannelTable, signals: Sequence[str], given: Sequence[str]) -> dict[str, Array]:
    """Return signal -> values in the units of `UNITS`."""
    named = name_signals(table, signals, given)
    missing = [signal for signal in signals if signal not in named]
    require(
        not missing,
        f"{table.path}: no column {' and no column '.join(missing[:3])}; it has "
        f"{shorten(', '.join(table.names), 200)}; name it by "
        f"recorded.columns=[{missing[0] if missing else ''}:NAME]",
    )
    loaded = table.load(list(dict.fromkeys(name for name, _ in named.values())), None)
    return {
        signal: loaded[name] * _find_factor(unit, UNITS[signal], f"{table.path}: column {name}")
        for signal, (name, unit) in named.items()
    }


def _find_factor(unit: str, wanted: str, argument: str) -> float:
    """Return the factor from the unit of a column; 1 if the file states none."""
    if wanted == "deg" and unit:
        return float(np.rad2deg(find_factor_to("rad", unit, argument)))
    return find_factor_to(wanted, unit, argument)


def _check_times(path: Path, time: Array) -> None:
    back = np.flatnonzero(~(np.diff(time) > 0.0))
    require(
        len(time) > 1 and len(back) == 0,
        f"{path}: the time does not increase in data row {back[0] + 2 if len(back) else 1}; sort "
        "the rows, and leave out repeated ones",
    )
