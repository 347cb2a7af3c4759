"""From a file to the record that is replayed."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import replace
from threading import Lock
from typing import Any

from owtsweep.config import require
from owtsweep.errors import InputError
from owtsweep.motion.recorded import Limits, Recording, read
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.memory import give_back
from owtsweep.studies.replay.of_motion import of_motion
from owtsweep.studies.replay.of_sensors import of_sensors
from owtsweep.studies.replay.record import Record

#: Records that are kept, and bytes that they may hold beside the newest.
_KEPT, _KEPT_BYTES = 2, 1 << 28
_RECORDS: OrderedDict[Any, Record] = OrderedDict()
_LOCK = Lock()


def load_record(config: ReplayConfig, file: str) -> Record:
    """Read, check and resample a file; the last few are kept, of long ones the last alone.

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
            while _RECORDS and (
                len(_RECORDS) >= _KEPT or sum(r.nbytes for r in _RECORDS.values()) > _KEPT_BYTES
            ):
                _RECORDS.popitem(last=False)
            _RECORDS[key] = _load(config, file)
            give_back(_RECORDS[key])
        return _RECORDS[key]


def _load(config: ReplayConfig, file: str) -> Record:
    limits = Limits(gaps=config.gaps)
    recording = read(
        file, columns=config.columns.given(), units=config.units.given(), limits=limits
    )
    sensors = sensing.sensors(config.sensors)
    if _is_sensors(config, recording):
        record = of_sensors(config, _with_reference(recording), sensors, limits)
    else:
        require(
            config.replay.gnss == "auto",
            f"{file}: replay.gnss={config.replay.gnss} is for recorded sensors; with a motion "
            "fixes are simulated: leave it at auto, or set columns.specific_force_x",
        )
        record = of_motion(config, _with_position(recording), sensors, limits)
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
