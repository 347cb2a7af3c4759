"""Load the record in a file; give files labels and hashes.

If the roles guessed for a file's channels give no record, the error says which they can have.
"""

from __future__ import annotations

import shlex
from dataclasses import dataclass, field, replace
from functools import lru_cache
from threading import Lock

from owtsweep.config import require
from owtsweep.errors import InputError
from owtsweep.motion.recorded import Recording, read
from owtsweep.studies.hub.public import make_sensors
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.files import hash_file
from owtsweep.studies.replay.of_motion import make_record_of_motion
from owtsweep.studies.replay.of_sensors import make_record_of_sensors, measure_rates
from owtsweep.studies.replay.record import ReplayRecord, release_memory

#: Bytes above which a record does not stay in memory beside another one.
_MOST_BYTES = 1 << 28
_KEPT: dict[Source, ReplayRecord] = {}
_LOCK = Lock()
#: Quantity that alone gives no record -> the quantity its channels can be instead, and when.
INSTEAD = {
    "acceleration": ("specific_force", "if a level IMU measured them"),
    "fix": ("position", "if they are the motion itself and not a receiver's noisy fixes"),
}


@dataclass(frozen=True)
class Source:
    """A record's file as a key of caches: equal if its content and what is made of it are equal."""

    file: str
    digest: str
    settings: str
    config: ReplayConfig = field(compare=False)


def name_source(config: ReplayConfig, file: str, *more: object) -> Source:
    """Return the key of what depends on the record in a file and on `more`."""
    settings = (config.columns, config.units, config.gaps, config.sensors, config.measures, *more)
    return Source(file, hash_file(file), repr(settings), config)


def load_record(config: ReplayConfig, file: str) -> ReplayRecord:
    """Read, check and resample the record in a file.

    The last record stays in memory, and perhaps one more if both are small.
    Raises InputError if anything is wrong with the file; the one-line message names it.
    """
    source = name_source(config, file, config.replay)
    with _LOCK:  # threads share a record
        if source not in _KEPT:
            if len(_KEPT) > 1 or any(one.nbytes > _MOST_BYTES for one in _KEPT.values()):
                _KEPT.clear()  # first, to save memory
            _KEPT[source] = _load(config, file)
            release_memory(_KEPT[source])
        return _KEPT[source]


def tell_lean(config: ReplayConfig, file: str) -> str:
    """Return `ReplayRecord.lean` of a file; read it only if it was not read before."""
    return _tell_lean(name_source(config, file, config.replay))


@lru_cache(maxsize=4096)
def _tell_lean(source: Source) -> str:
    return load_record(source.config, source.file).lean


def _load(config: ReplayConfig, file: str) -> ReplayRecord:
    recording = read(
        file,
        columns=config.columns.given(),
        units=config.units.given(),
        gaps=config.gaps,
        motion=config.columns.motion,
        tower_height=config.columns.tower_height,
        rotation=config.columns.rotation,
    )
    sensors = make_sensors(config.sensors)
    if _holds_sensors(config, recording):
        # positions recorded together with a specific force are the reference
        recording = _rename(recording, "position", "reference")
        record = make_record_of_sensors(config, recording, sensors)
    else:
        require(
            config.replay.gnss == "auto",
            f"{file}: replay.gnss={config.replay.gnss} needs a recorded specific force, but the "
            "file is replayed as motion; use replay.gnss=auto, or set columns.specific_force_x",
        )
        recording = _rename(recording, "reference", "position")
        if not recording.has("position"):
            raise InputError(_explain_no_motion(config, recording))
        record = make_record_of_motion(config, recording, sensors)
    length, settling = record.steps * record.step, config.measures.settling_time
    require(
        length >= settling + sensors.fix_step,
        f"{file}: the record lasts {length:.4g} s, no longer than measures.settling_time "
        f"({settling:g} s) and one interval between fixes; use a longer record, or a shorter "
        "settling time",
    )
    return record


def _holds_sensors(config: ReplayConfig, recording: Recording) -> bool:
    has_force = recording.has("specific_force")
    if config.replay.input == "sensors" and not has_force:
        raise InputError(
            f"{recording.path}: replay.input=sensors, but there is no specific force: set "
            "columns.specific_force_x and columns.specific_force_y"
        )
    return has_force and config.replay.input != "motion"


def _rename(recording: Recording, old: str, new: str) -> Recording:
    if recording.has(new) or not recording.has(old):
        return recording
    swap = {f"{old}_{axis}": f"{new}_{axis}" for axis in "xy"}
    return replace(
        recording,
        channels={swap.get(role, role): item for role, item in recording.channels.items()},
        names={swap.get(role, role): item for role, item in recording.names.items()},
    )


def _explain_no_motion(config: ReplayConfig, recording: Recording) -> str:
    found = [quantity for quantity in INSTEAD if recording.has(quantity)]
    if not found or recording.has("specific_force"):
        return f"{recording.path}: no position: set columns.position_x and columns.position_y"
    text = f"{recording.path}: no position and no specific force"
    for quantity in found:
        role, when = INSTEAD[quantity]
        names = [recording.names[f"{quantity}_{a}"] for a in _axes(recording, quantity)]
        text += f"; {' and '.join(names)}, taken as {quantity}, can be {role}, {when}"
    if found == ["acceleration"]:
        return f"{text}, and beside fixes (columns.fix_x) or a reference (columns.reference_x)"
    kind = "an IMU and a GNSS" if "acceleration" in found else "motion"
    return f"{text}. For {kind}: {_write_command(config, recording, found[0])}"


def _write_command(config: ReplayConfig, recording: Recording, quantity: str) -> str:
    new = {f"{quantity}_{a}": f"{INSTEAD[quantity][0]}_{a}" for a in _axes(recording, quantity)}
    shown = [*new, *(f"fix_{a}" for a in _axes(recording, "fix") if f"fix_{a}" not in new)]
    columns = {**config.columns.given(), **{role: recording.names[role] for role in shown}}
    words = [f"columns.{new.get(role, role)}={name}" for role, name in columns.items()]
    words += [f"units.{new.get(role, role)}={u}" for role, u in config.units.given().items()]
    if quantity == "acceleration":
        words += [
            f"sensors.{sensor}.rate={rate:.12g}"
            for sensor, rate in measure_rates(config, recording, quantity).items()
            if rate != getattr(config.sensors, sensor).rate
        ]
    return shlex.join(["owtsweep", "replay", str(recording.path), *words])


def _axes(recording: Recording, quantity: str) -> list[str]:
    return [axis for axis in "xy" if f"{quantity}_{axis}" in recording.channels]
