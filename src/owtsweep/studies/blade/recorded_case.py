"""Reads a recorded lift, and puts it in the place of a simulated one.

Nobody knows the truth of a record. Its reference is the smoother with all fixes, as in
post-processing: its own errors are in every number, and in its own they are missing. Outages are
made by withholding fixes, and `withheld` compares estimates with these.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.evaluation.measures import compute_rms_length
from owtsweep.io.reading import expand_home
from owtsweep.motion.recorded import Signals, Wanted, open_table, read_signals
from owtsweep.motion.recorded.formats.nmea import FORMAT as NMEA
from owtsweep.motion.recorded.formats.table import ChannelTable
from owtsweep.motion.recorded.formats.text_layout import ISO_TIME
from owtsweep.motion.recorded.signals import read_fixes
from owtsweep.studies.blade.aligning import align
from owtsweep.studies.blade.config import BladeConfig
from owtsweep.studies.blade.contract import Estimates, Geometry, Measured, Setting, Start, Truth
from owtsweep.studies.blade.recorded import REFERENCE
from owtsweep.studies.blade.schemes import SCHEMES

FORCE, RATE = ("fx", "fy", "fz"), ("wx", "wy", "wz")
LOCAL, GLOBE = ("x", "y", "z"), ("latitude", "longitude", "height")
OF_UNIT = dict.fromkeys(FORCE, "acceleration") | dict.fromkeys(RATE, "angular velocity")
OF_ANTENNA = {
    **dict.fromkeys((*LOCAL, "height"), "length"),
    **dict.fromkeys(("latitude", "longitude"), "latitude or longitude"),
}
UNIT = Wanted("recorded.columns", OF_UNIT.get, ", ".join(OF_UNIT), (*FORCE, *RATE))
ANTENNA = Wanted("recorded.columns", OF_ANTENNA.get, ", ".join(OF_ANTENNA))
#: Heights of NMEA above the geoid, whose separation from the ellipsoid no sentence states; and the
#: qualities of its fixes, of which one is a float solution.
ALTITUDE, QUALITY, FLOAT = "altitude", "gga_quality", 5


class Fixes(NamedTuple):
    """What an antenna says at n times."""

    path: Path
    time: Array  # s
    position: Array  # (n, 3): x, y, z in m, or latitude and longitude in deg, and height in m
    globe: bool  # whether it is the latter
    floating: NDArray[np.bool_]  # (n,), whether a solution is float
    above_geoid: bool  # whether heights are, because the file does not state its separation


class Lift(NamedTuple):
    """A recorded lift with all its fixes, and how it begins."""

    measured: Measured
    start: Start
    inertial: Signals


def load_lift(config: BladeConfig) -> Lift:
    """Read a recorded lift, from the first fix of the first antenna on.

    Raises InputError if a file cannot be used, the record is too short or has another rate, GNSS is
        faster than the inertial unit, or the heading is unknown.
    """
    recorded, rate, steps = config.recorded, config.record.rate, config.record.steps
    path = expand_home(str(recorded.imu))
    tables = [open_table(expand_home(name)) for name in recorded.gnss]
    for table in (open_table(path), *tables):
        require(
            ISO_TIME not in table.units,
            f"{table.path}: its times are dates, which become seconds from the file's first, and "
            "files of a lift need one clock; write seconds of one clock",
        )
    inertial = read_signals(path, UNIT, recorded.columns, [(table, ANTENNA) for table in tables])
    antennas = [read_antenna(table, recorded.columns) for table in tables]
    placed, floating = _place_fixes(antennas, inertial, recorded.shift)
    there = np.flatnonzero(np.isfinite(placed[:, 0, 0]))
    require(
        len(there) > 1,
        f"{antennas[0].path}: fewer than two fixes fall into the time of {path}; is "
        "recorded.shift right?",
    )
    begin = int(there[0])
    inertial.require_record(rate, steps, begin)
    part = slice(begin, begin + steps)
    every = max(round(float(np.median(np.diff(there)))), 1)
    fixes = placed[part]
    due = np.isfinite(fixes[:, 0, 0])
    around = np.ones(max(every // 2, 1) * 2 + 1, dtype=int)  # half of the interval to either side
    due[::every] |= (np.convolve(due.astype(int), around, "same") == 0)[::every]
    force = inertial.stack(FORCE)[part] @ recorded.turn.T
    measured = Measured(
        step=1.0 / rate,
        specific_force=force,
        rate=inertial.stack(RATE)[part] @ recorded.turn.T,
        fixes=fixes,
        due=due,
        floating=floating[part],
        prism_times=np.empty(0),
        prisms=np.empty((0, 3, 3)),
    )
    return Lift(measured, align(recorded, force, fixes, 1.0 / rate), inertial)


def read_antenna(table: ChannelTable, columns: Sequence[str]) -> Fixes:
    """Read the positions of an antenna from an opened file.

    Raises InputError if a column is missing, times do not increase, or a position is impossible.
    """
    named = {item.partition(":")[0] for item in columns}
    globe = "latitude" in (*table.names, *named) and "x" not in table.names
    names, dimensions = GLOBE if globe else LOCAL, OF_ANTENNA
    bare = table.format == NMEA and ALTITUDE in table.names
    if bare:
        names = (*GLOBE[:2], ALTITUDE)
    if table.format == NMEA:
        dimensions = OF_ANTENNA | {ALTITUDE: "length", QUALITY: "number"}
    found = read_fixes(table, replace(ANTENNA, dimension=dimensions.get, needed=names), columns)
    position = found.stack(names)
    for i, (name, most) in enumerate((("latitude", 90.0), ("longitude", 360.0)) if globe else ()):
        wrong = np.flatnonzero(np.abs(position[:, i]) > most)
        if len(wrong):
            row = wrong[0]
            raise InputError(
                f"{table.path}: a {name} of {position[row, i]:g} degrees in data row {row + 1}; "
                f"give decimal degrees up to {most:g}"
            )
    quality = found.values.get(QUALITY, np.zeros(len(found.time)))
    return Fixes(table.path, found.time, position, globe, quality == FLOAT, bare)


def _place_fixes(
    antennas: list[Fixes], inertial: Signals, shift: float
) -> tuple[Array, NDArray[np.bool_]]:
    """Return fixes at the nearest samples, m, shape (steps, k, 3), and where they are float.

    The frame is that of the files, or has x north, y west and z up from the first fix on the globe.
    """
    globe = {fixes.globe for fixes in antennas}
    require(
        len(globe) == 1,
        "recorded.gnss: some files have x, y, z and others latitude and longitude; give one kind",
    )
    bare = [fixes.path for fixes in antennas if fixes.above_geoid]
    require(
        len(bare) in (0, len(antennas)),
        f"recorded.gnss: no sentence of {bare[0] if bare else ''} states the geoid's separation, "
        "and heights of other files are above the ellipsoid; add the separation",
    )
    time, step = inertial.time, inertial.step
    placed = np.full((len(time), len(antennas), 3), np.nan)
    floating = np.zeros(len(time), dtype=bool)
    for k, fixes in enumerate(antennas):
        between = float(np.median(np.diff(fixes.time)))
        require(
            between > 0.99 * step,
            f"{fixes.path}: a fix every {between:g} s is faster than the inertial unit's {step:g} "
            "s; thin the fixes out",
        )
        position = _level(fixes, antennas[0].position[0]) if fixes.globe else fixes.position
        at = np.round((fixes.time + shift - time[0]) / step).astype(int)
        inside = (at >= 0) & (at < len(time))
        placed[at[inside], k] = position[inside]
        floating[at[inside]] |= fixes.floating[inside]
    return placed, floating


def _level(fixes: Fixes, origin: Array) -> Array:
    try:
        from pymap3d import geodetic2enu
    except ModuleNotFoundError:
        raise InputError(
            f"{fixes.path}: latitudes need the package pymap3d; install the extra: "
            "pip install 'owtsweep[gnss]'"
        ) from None
    east, north, up = geodetic2enu(*fixes.position.T, *origin)
    return np.column_stack([north, -np.asarray(east), up])


def find_reference(lift: Lift, setting: Setting) -> Truth:
    """Return what stands for the truth: the smoother with all fixes, given a setting."""
    measured = lift.measured
    found = SCHEMES.resolve(REFERENCE).prepare(setting).run(measured)
    to_unit = -setting.geometry.to_root
    return Truth(
        step=measured.step,
        rotation=found.rotation,
        root=found.root,
        root_velocity=found.root_velocity,
        unit=found.root + found.rotation @ to_unit,
        unit_velocity=found.root_velocity
        + np.einsum("nij,nj->ni", found.rotation, np.cross(measured.rate, to_unit)),
        rate=measured.rate,
        specific_force=measured.specific_force,
    )


def compare_withheld(estimates: Estimates, fixes: Array, geometry: Geometry) -> float | None:
    """Return the rms difference between estimates and withheld fixes of the first antenna, m.

    `fixes` are those, shape (steps, 3), NaN where none was withheld; None if none was at all.
    """
    there = np.isfinite(fixes[:, 0])
    if not there.any():
        return None
    lever = geometry.antennas[0] - geometry.root
    return compute_rms_length((estimates.root + estimates.rotation @ lever - fixes)[there])
