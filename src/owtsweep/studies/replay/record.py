"""A recording made ready: on the IMU's grid, from the first moment at which a fix is due."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, replace
from threading import Lock
from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import require
from owtsweep.errors import InputError
from owtsweep.motion.recorded import (
    Grid,
    Limits,
    Recording,
    grid_of,
    read,
    to_grid,
    to_motion,
)
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.replay import fixes as fixing
from owtsweep.studies.replay.config import ReplayConfig

#: Fixes further than this part of the GNSS interval from their moment make no grid.
LARGEST_JITTER = 0.25


@dataclass(frozen=True)
class Record:
    """What a replay runs on; all in NED with the origin taken off, SI units.

    Attributes
    ----------
    file
        Where it came from.
    kind
        "motion" or "sensors".
    gnss
        "simulated" (motion), "recorded" or "from_reference" (sensors).
    begin, step, steps
        Time of step 0 on the file's clock (s), interval (s), number of IMU steps.
    origin
        (2,) what was taken off the positions, m.
    position, velocity
        (steps, 2) the truth, NaN where it is unknown; None without a reference.
    acceleration
        (steps, 2), of a motion.
    specific_force
        (steps, 2) in the IMU's frame, of recorded sensors.
    fixes
        (fixes, 2): as recorded, or without noise; NaN where there is none.
    truth
        What the truth is, in words.
    notes
        What a user should know.
    """

    file: str
    kind: str
    gnss: str
    begin: float
    step: float
    steps: int
    origin: Array
    position: Array | None
    velocity: Array | None
    acceleration: Array | None
    specific_force: Array | None
    fixes: Array
    truth: str
    notes: tuple[str, ...]

    @property
    def time(self) -> Array:
        """(steps,) s, on the file's clock."""
        return np.asarray(self.begin + self.step * np.arange(self.steps))

    def given(self, name: str) -> Array:
        """A series that must be there, by name."""
        series: Array | None = getattr(self, name)
        if series is None:
            raise TypeError(f"{self.file}: the record has no {name}")
        return series


_KEPT = 2
_RECORDS: OrderedDict[Any, Record] = OrderedDict()
_LOCK = Lock()


def load_record(config: ReplayConfig, file: str) -> Record:
    """Read, check and resample a file; the last few are kept.

    Raises
    ------
    InputError
        For anything that is wrong in it, in one line that names the file.
    """
    from owtsweep.studies.replay.blocks import digest

    settings = (config.columns, config.units, config.gaps, config.replay, config.sensors)
    key = (file, digest(file), repr(settings), config.measures.settling_time)
    with _LOCK:
        if key not in _RECORDS:
            _RECORDS[key] = _load(config, file)
            while len(_RECORDS) > _KEPT:
                _RECORDS.popitem(last=False)
        return _RECORDS[key]


def _load(config: ReplayConfig, file: str) -> Record:
    limits = Limits(gaps=config.gaps)
    recording = read(
        file, columns=config.columns.given(), units=config.units.given(), limits=limits
    )
    sensors = sensing.sensors(config.sensors)
    if _is_sensors(config, recording):
        record = _sensors(config, _with_reference(recording), sensors, limits)
    else:
        record = _motion(config, _with_position(recording), sensors, limits)
    length, settling = record.steps * record.step, config.measures.settling_time
    require(
        length >= settling + sensors.fix_step,
        f"{file}: the record gives {length:.4g} s, no longer than measures.settling_time "
        f"{settling:g} s and one fix; use a longer one, or a shorter settling time",
    )
    return record


def _is_sensors(config: ReplayConfig, recording: Recording) -> bool:
    has_force = recording.has("specific_force")
    if config.replay.input == "sensors" and not has_force:
        raise InputError(
            f"{recording.path}: replay.input=sensors, but there is no specific force: set "
            "columns.specific_force_x and columns.specific_force_y"
        )
    return has_force and config.replay.input != "motion"


def _with_reference(recording: Recording) -> Recording:
    """Positions beside a specific force are the reference."""
    return _renamed(recording, "position", "reference")


def _with_position(recording: Recording) -> Recording:
    """A reference that is to be replayed as motion."""
    return _renamed(recording, "reference", "position")


def _renamed(recording: Recording, old: str, new: str) -> Recording:
    if recording.has(new) or not recording.has(old):
        return recording
    swap = {f"{old}_{axis}": f"{new}_{axis}" for axis in "xy"}
    return replace(
        recording,
        channels={swap.get(role, role): item for role, item in recording.channels.items()},
        names={swap.get(role, role): item for role, item in recording.names.items()},
    )


def _motion(config: ReplayConfig, recording: Recording, sensors: Sensors, limits: Limits) -> Record:
    rate = config.sensors.imu.rate
    grid = to_motion(recording, rate, cutoff=config.replay.cutoff, limits=limits)
    position, velocity, acceleration = (
        np.stack([grid.channels[f"{name}_{axis}"] for axis in "xy"], axis=1)
        for name in ("position", "velocity", "acceleration")
    )
    origin = position.mean(axis=0) if config.replay.remove_mean else np.zeros(2)
    position = position - origin
    first = sensors.delay  # what the first fix reports stands before step 0
    steps = len(position) - first
    require(
        steps > 0, f"{recording.path}: the record is shorter than sensors.gnss.delay; lengthen it"
    )
    return Record(
        file=str(recording.path),
        kind="motion",
        gnss="simulated",
        begin=grid.grid.start + first / rate,
        step=sensors.step,
        steps=steps,
        origin=origin,
        position=position[first:],
        velocity=velocity[first:],
        acceleration=acceleration[first:],
        specific_force=None,
        fixes=fixing.from_reference(position, first, steps, sensors),
        truth="the recorded motion",
        notes=(*recording.notes, *grid.notes),
    )


def _sensors(
    config: ReplayConfig, recording: Recording, sensors: Sensors, limits: Limits
) -> Record:
    rate = config.sensors.imu.rate
    forces = [role for role in recording.channels if role.startswith("specific_force")]
    whole = grid_of(recording, forces, rate)
    gnss = _gnss(config, recording)
    notes = [*recording.notes]
    slow = min(recording.rate(role) for role in forces)
    if slow < 0.999 * rate:
        notes.append(
            f"specific force comes at {slow:.4g} Hz and is run at {rate:g} Hz, its noise no longer "
            "white; a lower sensors.imu.rate avoids that"
        )
    offset, values = sensors.delay, None
    if gnss == "recorded":
        aligned = _aligned(recording, whole, sensors)
        offset, values = round(aligned.offset * rate), aligned.values
        notes += _said(aligned)
    grid = Grid(whole.start + offset / rate, rate, whole.steps - offset)
    gridded = to_grid(recording, forces, rate, grid=grid, limits=limits)
    zero = np.zeros(grid.steps)
    force = np.stack(
        [gridded.channels.get(f"specific_force_{axis}", zero) for axis in "xy"], axis=1
    )
    notes += gridded.notes
    position = velocity = None
    if recording.has("reference"):
        position, velocity, said = _reference(config, recording, whole, limits)
        notes += said
    origin = np.zeros(2)
    if config.replay.remove_mean:
        known = values if position is None else position
        origin = np.nanmean(np.asarray(known), axis=0)
    if position is not None and velocity is not None:
        position = position - origin
        if values is None:
            values = fixing.from_reference(position, offset, grid.steps, sensors)
        else:
            values = values - origin
        position, velocity = position[offset:], velocity[offset:]
    elif values is not None:
        values = values - origin
    if values is None:
        raise TypeError("neither fixes nor a reference")
    return Record(
        file=str(recording.path),
        kind="sensors",
        gnss=gnss,
        begin=grid.start,
        step=sensors.step,
        steps=grid.steps,
        origin=origin,
        position=position,
        velocity=velocity,
        acceleration=None,
        specific_force=force,
        fixes=values,
        truth="the reference" if position is not None else "",
        notes=tuple(notes),
    )


def _gnss(config: ReplayConfig, recording: Recording) -> str:
    """Where the fixes come from."""
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


def _aligned(recording: Recording, grid: Grid, sensors: Sensors) -> fixing.Aligned:
    time = recording.time - grid.start
    axes = [recording.channels.get(f"fix_{axis}") for axis in "xy"]
    values = np.stack([np.zeros(len(time)) if a is None else a for a in axes], axis=1)
    inside = (time >= 0.0) & (time <= (grid.steps - 1) / grid.rate)
    try:
        aligned = fixing.align(time[inside], values[inside], (grid.steps - 1) / grid.rate, sensors)
    except InputError as error:
        raise InputError(f"{recording.path}: {error}") from None
    if aligned.jitter > LARGEST_JITTER * sensors.fix_step:
        own = np.diff(time[np.all(np.isfinite(values), axis=1)])
        raise InputError(
            f"{recording.path}: fixes come up to {aligned.jitter:.3g} s away from a grid of "
            f"{1.0 / sensors.fix_step:g} Hz (their median interval is {np.median(own):.4g} s); "
            "set sensors.gnss.rate to their rate"
        )
    return aligned


def _said(aligned: fixing.Aligned) -> list[str]:
    notes = []
    if aligned.jitter > 1e-6:
        notes.append(
            f"fixes: irregular by up to {aligned.jitter:.3g} s; each was moved to the nearest "
            "moment at which one is due"
        )
    missing = int(np.count_nonzero(~np.isfinite(aligned.values[:, 0])))
    if missing:
        notes.append(
            f"fixes: {missing} of {len(aligned.values)} are missing; the filters run through"
        )
    if aligned.dropped:
        notes.append(f"fixes: {aligned.dropped} dropped, another stood for the same moment")
    return notes


def _reference(
    config: ReplayConfig, recording: Recording, grid: Grid, limits: Limits
) -> tuple[Array, Array, list[str]]:
    """Position and velocity of the reference on the grid, NaN where it is not."""
    found = to_motion(
        recording, grid.rate, quantity="reference", cutoff=config.replay.cutoff, grid=grid,
        limits=limits,
    )  # fmt: skip
    position, velocity = (
        np.stack([found.channels[f"{name}_{axis}"] for axis in "xy"], axis=1)
        for name in ("position", "velocity")
    )
    unknown = ~np.all(np.isfinite(position), axis=1)
    for axis in "xy":
        if f"reference_{axis}" in recording.channels:
            span = recording.series(f"reference_{axis}")[0][[0, -1]]
            unknown |= (grid.time < span[0] - 1e-9) | (grid.time > span[1] + 1e-9)
    require(
        not np.all(unknown),
        f"{recording.path}: the reference and the specific force do not overlap",
    )
    position[unknown] = velocity[unknown] = np.nan
    return position, velocity, list(found.notes)
