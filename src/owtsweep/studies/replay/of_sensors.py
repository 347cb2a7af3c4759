"""Make a record from recorded sensors: specific force, fixes, perhaps a reference."""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import require
from owtsweep.errors import InputError
from owtsweep.motion.recorded import (
    MOTION_CUTOFF,
    Recording,
    TimeGrid,
    find_clear_band,
    find_common_grid,
    to_grid,
    to_motion,
)
from owtsweep.motion.recorded.recording import fit_comb
from owtsweep.studies.hub.public import Sensors, fix_count
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.record import ReplayRecord, make_fixes

#: A record with fewer fixes is refused.
LEAST_FIXES = 3
#: Largest time between a fix and its due moment, as a fraction of the GNSS interval.
LARGEST_JITTER = 0.25


class Aligned(NamedTuple):
    """Recorded fixes, moved to the regular moments at which fixes are due.

    offset: from the beginning of the recording to the first such moment, s.
    values: one fix per due moment, shape (fixes, 2) in m; NaN where no fix came.
    jitter: largest time between the arrival of a fix and its moment, s.
    dropped: number of fixes left out, because another was nearer to the same moment.
    """

    offset: float
    values: Array
    jitter: float
    dropped: int


def make_record_of_sensors(
    config: ReplayConfig, recording: Recording, sensors: Sensors
) -> ReplayRecord:
    """Make a record from recorded specific force, fixes and reference position.

    It begins when a first fix is due. Channels are removed from `recording` once resampled.
    Raises InputError if there are neither fixes nor a reference, fixes do not come at
        sensors.gnss.rate, or reference and specific force do not overlap in time.
    """
    rate = config.sensors.imu.rate
    forces = [role for role in recording.channels if role.startswith("specific_force")]
    whole = find_common_grid(recording, forces, rate)
    gnss = _choose_gnss(config, recording)
    measured = measure_rates(config, recording)
    notes = [*recording.notes, _tell_roles(recording, measured["gnss"])]
    if measured["imu"] < rate:
        notes.append(
            f"specific force comes at {measured['imu']:.4g} Hz and is run at {rate:g} Hz, its "
            f"noise no longer white; sensors.imu.rate={measured['imu']:.6g} avoids that"
        )
    offset, fixes = sensors.delay, None
    if gnss == "recorded":
        notes += _drop_repeated(recording)
        aligned = _align_fixes(recording, whole, sensors, measured["gnss"])
        offset, fixes = round(aligned.offset * rate), aligned.values
        notes += _note_fixes(aligned, sensors, measured["gnss"])
    recording.let_go("fix")
    grid = TimeGrid(whole.start + offset / rate, rate, whole.steps - offset)
    force = np.zeros((grid.steps, 2))
    for role in forces:
        force[:, "xy".index(role[-1])] = to_grid(recording, role, grid)
    recording.let_go("specific_force")
    position = velocity = None
    if recording.has("reference"):
        position, velocity, more = _derive_reference(config, recording, whole)
        notes += more
        if fixes is None:
            fixes = make_fixes(position, offset, grid.steps, sensors)
    known = np.asarray(fixes if position is None else position)
    origin = np.nanmean(known, axis=0) if config.replay.remove_mean else np.zeros(2)
    if position is not None and velocity is not None:
        position -= origin
        position, velocity = position[offset:], velocity[offset:]
    return ReplayRecord(
        file=str(recording.path),
        gnss=gnss,
        begin=grid.start,
        step=sensors.step,
        steps=grid.steps,
        origin=origin,
        position=position,
        velocity=velocity,
        specific_force=force,
        fixes=np.asarray(fixes) - origin,
        truth="the reference" if position is not None else "",
        notes=tuple(notes),
    )


def measure_rates(config: ReplayConfig, recording: Recording) -> dict[str, float]:
    """Return the rates (Hz) at which to run sensors, "imu" and "gnss", as a recording shows them.

    That of the IMU is the stated one, or its own if that is lower. Without fixes, that of GNSS is
    the stated one.
    """
    roles = [role for role in recording.channels if role.startswith("specific_force")]
    slow = min(1.0 / fit_comb(recording.series(role)[0]).step for role in roles)
    imu = config.sensors.imu.rate
    imu = imu if slow >= 0.999 * imu else float(f"{slow:.6g}")
    gnss = config.sensors.gnss.rate
    fix = next((role for role in recording.channels if role.startswith("fix")), None)
    if fix is not None:
        time, value = recording.series(fix)
        came = time[np.flatnonzero(np.diff(value, prepend=np.nan))]  # a repeated fix is no new one
        if len(came) > 1:
            gnss = imu / max(round(imu * fit_comb(came).step), 1)
    return {"imu": imu, "gnss": gnss}


def _tell_roles(recording: Recording, gnss_rate: float) -> str:
    said = []
    for quantity, what in (
        ("specific_force", "specific force of a level IMU"),
        ("fix", "fixes"),
        ("reference", "reference"),
    ):
        found = {a: r for a in "xy" if (r := f"{quantity}_{a}") in recording.channels}
        if found:
            rate = gnss_rate if quantity == "fix" else recording.rate(next(iter(found.values())))
            names = ", ".join(recording.names[role] for role in found.values())
            said.append(f"{what}: {names} at {rate:.4g} Hz")
    return f"{'; '.join(said)} (columns.ROLE=NAME takes others)"


def _choose_gnss(config: ReplayConfig, recording: Recording) -> str:
    wanted = config.replay.gnss
    if wanted == "auto":
        wanted = "recorded" if recording.has("fix") else "from_reference"
    if wanted == "recorded" and not recording.has("fix"):
        raise InputError(
            f"{recording.path}: replay.gnss=recorded, but there are no fixes: set columns.fix_x "
            "and columns.fix_y, or use replay.gnss=from_reference"
        )
    if wanted == "from_reference" and not recording.has("reference"):
        raise InputError(
            f"{recording.path}: there is a specific force, but neither fixes nor a reference: set "
            "columns.fix_x and columns.fix_y, or columns.reference_x and columns.reference_y"
        )
    return wanted


def _drop_repeated(recording: Recording) -> list[str]:
    # a logger may repeat the last fix in each row of the IMU; rounded fixes repeat now and then
    fixes = [values for role, values in recording.channels.items() if role.startswith("fix")]
    there = np.flatnonzero(np.all(np.isfinite(fixes), axis=0))
    fresh = np.any([np.diff(values[there], prepend=np.nan) != 0.0 for values in fixes], axis=0)
    count = int(np.count_nonzero(fresh))
    if not LEAST_FIXES <= count < 0.5 * len(there):
        return []
    for values in fixes:
        values[there[~fresh]] = np.nan
    return [f"fixes: {len(there) - count} rows repeat the fix before them and count as no fix"]


def _align_fixes(
    recording: Recording, grid: TimeGrid, sensors: Sensors, measured: float
) -> Aligned:
    time = recording.time - grid.start
    axes = [recording.channels.get(f"fix_{axis}") for axis in "xy"]
    values = np.stack([np.zeros(len(time)) if a is None else a for a in axes], axis=1)
    duration = (grid.steps - 1) / grid.rate
    came = np.all(np.isfinite(values), axis=1)
    inside = came & (time >= 0.0) & (time <= duration)
    count = int(np.count_nonzero(inside))
    require(
        count >= LEAST_FIXES,
        f"{recording.path}: columns.fix_x: the record holds {count} position fixes, but "
        f"{LEAST_FIXES} are needed; without fixes, give a reference and replay.gnss=from_reference",
    )
    aligned = align(time[inside], values[inside], duration, sensors)
    if aligned.jitter > LARGEST_JITTER * sensors.fix_step:
        raise InputError(
            f"{recording.path}: fixes arrive as much as {aligned.jitter:.3g} s before or after the "
            f"moments that a rate of {1.0 / sensors.fix_step:g} Hz gives; they come every "
            f"{1.0 / measured:.4g} s: set sensors.gnss.rate={measured:.6g}"
        )
    return aligned


def align(time: Array, values: Array, duration: float, sensors: Sensors) -> Aligned:
    """Move irregular fixes to the nearest regular moments; of two at one moment the nearer is kept.

    The moments are one GNSS interval apart, at IMU samples; their phase is the circular mean of the
    fixes' phases. Times (n,) are in s after the beginning, fixes (n, 2) in m without NaN.
    """
    interval = sensors.fix_step
    phase = np.angle(np.mean(np.exp(2j * np.pi * time / interval))) / (2.0 * np.pi)
    offset = float(phase * interval)
    if offset < -1e-9:  # the first moment must lie inside the record
        offset += interval
    # ... and at a sample of the IMU
    offset = max(round(offset / sensors.step), 0) * sensors.step
    steps = int((duration - offset) / sensors.step + 1e-9) + 1
    count = fix_count(steps, sensors.fix_interval)
    number = np.rint((time - offset) / interval).astype(int)
    away = np.abs(time - offset - number * interval)
    inside = (number >= 0) & (number < count)
    result = np.full((count, 2), np.nan)
    nearest_last = np.lexsort((-away[inside], number[inside]))  # the last assignment stays
    result[number[inside][nearest_last]] = values[inside][nearest_last]
    dropped = int(np.count_nonzero(inside) - np.count_nonzero(np.isfinite(result[:, 0])))
    jitter = float(np.max(away[inside])) if np.any(inside) else 0.0
    return Aligned(offset, result, jitter, dropped)


def _note_fixes(aligned: Aligned, sensors: Sensors, measured: float) -> list[str]:
    notes = []
    if aligned.jitter > 1e-6:
        notes.append(
            f"fixes: irregular by up to {aligned.jitter:.3g} s; each was moved to the nearest "
            "moment at which one is due"
        )
    missing = int(np.count_nonzero(~np.isfinite(aligned.values[:, 0])))
    if missing:
        hint = ""
        if measured < 0.999 / sensors.fix_step:
            hint = f"; they come at {measured:.4g} Hz: set sensors.gnss.rate={measured:.6g}"
        notes.append(
            f"fixes: {missing} of {len(aligned.values)} are missing; the filters run through{hint}"
        )
    if aligned.dropped:
        notes.append(f"fixes: {aligned.dropped} dropped, another stood for the same moment")
    return notes


def _derive_reference(
    config: ReplayConfig, recording: Recording, grid: TimeGrid
) -> tuple[Array, Array, list[str]]:
    derive = partial(to_motion, recording, grid.rate, quantity="reference", orders=2, grid=grid)
    gridded = derive(cutoff=config.replay.cutoff)
    position, velocity = gridded.pairs["position"], gridded.pairs["velocity"]
    notes = list(gridded.notes)
    clear = find_clear_band(recording, grid.rate)
    if config.replay.cutoff is None and clear > MOTION_CUTOFF:
        del gridded  # of a long record, free this velocity before the next one is made
        velocity = derive(cutoff=clear).pairs["velocity"]
        notes.append(
            f"the reference's velocity is kept up to {clear:.3g} Hz, where its position is mostly "
            "noise or the rates end; replay.cutoff sets another frequency"
        )
    unknown = ~np.all(np.isfinite(position), axis=1)
    for role in [role for role in recording.channels if role.startswith("reference")]:
        span = recording.series(role)[0][[0, -1]]
        unknown |= (grid.time < span[0] - 1e-9) | (grid.time > span[1] + 1e-9)
    require(
        not np.all(unknown),
        f"{recording.path}: the reference and the specific force do not overlap in time; give "
        "a reference of the same time",
    )
    position[unknown] = velocity[unknown] = np.nan
    return position, velocity, notes
