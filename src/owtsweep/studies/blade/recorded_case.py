"""Puts a recorded lift in the place of a simulated one.

Nobody knows the truth of a record. Its reference is the smoother with all fixes, as in
post-processing: its own errors are in every number, and in its own they are missing. Outages are
made by withholding fixes, and `withheld` compares estimates with these.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.io.reading import expand_home
from owtsweep.motion.recorded.timing import fit_comb
from owtsweep.studies.blade.aligning import align
from owtsweep.studies.blade.contract import Estimates, Geometry, Measured, Setting, Truth
from owtsweep.studies.blade.recorded import REFERENCE
from owtsweep.studies.blade.recorded_files import (
    EXTRA,
    Fixes,
    check_columns,
    read_fixes,
    read_inertial,
)
from owtsweep.studies.blade.schemes import SCHEMES

if TYPE_CHECKING:
    from owtsweep.studies.blade.config import BladeConfig


class Lift(NamedTuple):
    """A recorded lift with all its fixes, and how it begins (as of `contract.Setting`)."""

    measured: Measured
    start: tuple[Array, Array]
    start_sigma: Array


def load_lift(config: BladeConfig) -> Lift:
    """Read a recorded lift, from the first fix of the first antenna on.

    Raises
    ------
    InputError
        If a file cannot be used, the record is too short or has another rate, GNSS is faster than
        the inertial unit, or the heading is unknown.
    """
    recorded, rate, steps = config.recorded, config.record.rate, config.record.steps
    path = expand_home(str(recorded.imu))
    files = [expand_home(name) for name in recorded.gnss]
    check_columns(recorded.columns, path, files)
    inertial = read_inertial(path, recorded.columns)
    comb = fit_comb(inertial.time)
    require(
        comb.uniform and comb.count == len(inertial.time),
        f"{path}: rows are not equally spaced in time; resample the record to one step",
    )
    require(
        abs(comb.step * rate - 1.0) < 1e-3,
        f"record.rate: {rate:g} Hz, but {path} has a row every {comb.step:g} s; set "
        f"record.rate={1.0 / comb.step:.6g}",
    )
    antennas = [read_fixes(file, recorded.columns) for file in files]
    placed, floating = place_fixes(antennas, files, inertial.time, recorded.shift)
    there = np.flatnonzero(np.isfinite(placed[:, 0, 0]))
    require(
        len(there) > 1,
        f"{files[0]}: fewer than two fixes fall into the time of {path}; is recorded.shift right?",
    )
    begin = int(there[0])
    require(
        begin + steps <= len(placed),
        f"record.duration: {steps / rate:g} s, but {path} lasts {(len(placed) - begin) / rate:g} s "
        f"from the first fix on; set record.duration={np.floor((len(placed) - begin) / rate):g}",
    )
    part = slice(begin, begin + steps)
    every = max(round(float(np.median(np.diff(there)))), 1)
    fixes = placed[part]
    due = np.isfinite(fixes[:, 0, 0])
    due[::every] |= ~_has_neighbour(due, every)[::every]
    force = inertial.force[part] @ recorded.turn.T
    measured = Measured(
        step=1.0 / rate,
        specific_force=force,
        rate=inertial.rate[part] @ recorded.turn.T,
        fixes=fixes,
        due=due,
        floating=floating[part],
        prism_times=np.empty(0),
        prisms=np.empty((0, 3, 3)),
    )
    start, sigma = align(recorded, force, fixes, 1.0 / rate)
    return Lift(measured, start, sigma)


def place_fixes(
    antennas: list[Fixes], files: list[Path], time: Array, shift: float
) -> tuple[Array, NDArray[np.bool_]]:
    """Return fixes at the nearest samples, m, shape (steps, k, 3), and where they are float.

    The frame has x north, y west and z up from the first fix if positions are on the globe, and is
    that of the files if not.

    Raises
    ------
    InputError
        If files differ in kind or in what heights are above, GNSS is faster than the samples, or a
        package is missing.
    """
    globe = {fixes.globe for fixes in antennas}
    require(
        len(globe) == 1,
        "recorded.gnss: some files have x, y, z and others latitude and longitude; give one kind",
    )
    bare = [file for file, fixes in zip(files, antennas, strict=True) if fixes.above_geoid]
    require(
        len(bare) in (0, len(files)),
        f"recorded.gnss: no sentence of {bare[0] if bare else ''} states the geoid's separation, "
        "and heights of other files are above the ellipsoid; add the separation",
    )
    step = float(time[1] - time[0])
    placed = np.full((len(time), len(antennas), 3), np.nan)
    floating = np.zeros(len(time), dtype=bool)
    for k, (fixes, file) in enumerate(zip(antennas, files, strict=True)):
        between = float(np.median(np.diff(fixes.time)))
        require(
            between > 0.99 * step,
            f"{file}: a fix every {between:g} s is faster than the inertial unit's {step:g} s; "
            "thin the fixes out",
        )
        position = (
            _level(fixes.position, antennas[0].position[0], file)
            if fixes.globe
            else (fixes.position)
        )
        at = np.round((fixes.time + shift - time[0]) / step).astype(int)
        inside = (at >= 0) & (at < len(time))
        placed[at[inside], k] = position[inside]
        floating[at[inside]] |= fixes.floating[inside]
    return placed, floating


def _level(position: Array, origin: Array, file: Path) -> Array:
    """Return positions on the globe (WGS84) as north, west and up of an origin, m, (n, 3)."""
    try:
        from pymap3d import geodetic2enu
    except ModuleNotFoundError:
        raise InputError(f"{file}: latitudes need the package pymap3d; {EXTRA}") from None
    east, north, up = geodetic2enu(*position.T, *origin)
    return np.column_stack([north, -np.asarray(east), up])


def _has_neighbour(due: NDArray[np.bool_], every: int) -> NDArray[np.bool_]:
    """Return at which samples there is a fix within half of the interval `every`."""
    near = np.convolve(due.astype(int), np.ones(max(every // 2, 1) * 2 + 1, dtype=int), "same")
    return np.asarray(near > 0)


def find_reference(lift: Lift, setting: Setting) -> Truth:
    """Return what stands for the truth: the smoother with all fixes, told a setting."""
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
    error = (estimates.root + estimates.rotation @ lever - fixes)[there]
    return float(np.sqrt(np.mean(np.sum(error**2, axis=1))))
