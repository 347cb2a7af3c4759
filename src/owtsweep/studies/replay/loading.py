"""Load the record in a file: of motion here, of sensors by `of_sensors`."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import lru_cache
from threading import Lock

import numpy as np

from owtsweep.config import require
from owtsweep.errors import InputError
from owtsweep.gravity import GRAVITY
from owtsweep.motion.recorded import Gridded, Recording, read, to_motion
from owtsweep.motion.recorded.composing import LEAST
from owtsweep.studies.hub.public import Sensors, make_sensors
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.files import hash_file
from owtsweep.studies.replay.of_sensors import make_record_of_sensors, measure_rates
from owtsweep.studies.replay.record import ReplayRecord, make_fixes

_KEPT: dict[Source, ReplayRecord] = {}
_LOCK = Lock()
#: Rows of a file in which the rates of its sensors are looked for.
ROWS = 200_000


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

    The last record stays in memory.
    Raises InputError if anything is wrong with the file; the one-line message names it.
    """
    source = name_source(config, file, config.replay)
    with _LOCK:  # threads share a record
        if source not in _KEPT:
            _KEPT.clear()  # first, to save memory
            _KEPT[source] = _load(config, file)
            _KEPT[source].release_memory()
        return _KEPT[source]


def tell_lean(config: ReplayConfig, file: str) -> str:
    """Return `ReplayRecord.lean` of a file; read it only if it was not read before."""
    return _tell_lean(name_source(config, file, config.replay))


@lru_cache(maxsize=4096)
def _tell_lean(source: Source) -> str:
    return load_record(source.config, source.file).lean


def _read(config: ReplayConfig, file: str, rows: int | None = None) -> Recording:
    return read(file, gaps=config.gaps, rows=rows, **config.reading())


def measure_sensors(config: ReplayConfig, files: Sequence[str]) -> dict[str, float]:
    """Return the rates (Hz) of recorded sensors, key -> rate, where all files say one other rate.

    Of a file its beginning is read; what is wrong with it is said when it is read as a whole.
    """
    found = []
    for file in files:
        with suppress(InputError):
            recording = _read(config, file, ROWS)
            if _holds_sensors(config, recording):
                found.append(measure_rates(config, recording))
    if not found or any(rates != found[0] for rates in found):
        return {}
    return {
        f"sensors.{sensor}.rate": rate
        for sensor, rate in found[0].items()
        if rate != getattr(config.sensors, sensor).rate
    }


def _load(config: ReplayConfig, file: str) -> ReplayRecord:
    recording = _read(config, file)
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
            raise InputError(_explain_no_motion(recording))
        record = _make_record_of_motion(config, recording, sensors)
    length, settling = record.steps * record.step, config.measures.settling_time
    require(
        length >= settling + sensors.fix_step,
        f"{file}: the record lasts {length:.4g} s, no longer than measures.settling_time "
        f"({settling:g} s) and one interval between fixes; use a longer record, or a shorter "
        "settling time",
    )
    return record


def _make_record_of_motion(
    config: ReplayConfig, recording: Recording, sensors: Sensors
) -> ReplayRecord:
    rate = config.sensors.imu.rate
    gridded = to_motion(recording, rate, cutoff=config.replay.cutoff)
    lowest = config.fit_band[0]
    require(
        gridded.cutoff > lowest,
        f"{recording.path}: frequencies of the motion are kept up to {gridded.cutoff:.3g} Hz only, "
        f"but the band begins at {lowest:g} Hz; check units.time, the record's rate, "
        "replay.cutoff and replay.band",
    )
    settling = config.measures.settling_time if config.measures.window == "settled" else 0.0
    lean = _describe_lean(recording, gridded, settling)
    position = gridded.pairs["position"]
    origin = position.mean(axis=0) if config.replay.remove_mean else np.zeros(2)
    position -= origin
    first = sensors.delay  # the first fix reports the position before step 0
    steps = len(position) - first
    require(
        steps > 0,
        f"{recording.path}: the record is shorter than sensors.gnss.delay; use a longer record or "
        "a shorter delay",
    )
    return ReplayRecord(
        file=str(recording.path),
        gnss="simulated",
        begin=gridded.grid.start + first / rate,
        step=sensors.step,
        steps=steps,
        origin=origin,
        position=position[first:],
        velocity=gridded.pairs["velocity"][first:],
        acceleration=gridded.pairs["acceleration"][first:],
        fixes=make_fixes(position, first, steps, sensors),
        truth="the recorded motion",
        notes=(*recording.notes, *gridded.notes),
        lean=lean,
    )


def _describe_lean(recording: Recording, gridded: Gridded, begin: float) -> str:
    """Compare standard deviations of g sin(pitch) and the acceleration, from `begin` (s) on.

    A constant lean is a constant bias, which schemes estimate.
    """
    sentences = []
    start = gridded.grid.start + begin
    for axis, (name, angle) in recording.leans.items():
        if f"position_{axis}" not in recording.channels:
            continue
        if angle is None:
            sentences.append(
                f"g sin({name}) along {axis} is not known, as {name} has no unit of angle"
            )
            continue
        there = angle[np.isfinite(angle) & (recording.time >= start)]
        if len(there) == 0 or np.ptp(there) <= LEAST["angle"]:
            continue
        felt = GRAVITY * np.sin(there)
        mean = round(float(felt.mean()), 4) + 0.0  # no -0, and no 1e-18
        after = gridded.pairs["acceleration"][round(begin * gridded.grid.rate) :, "xy".index(axis)]
        moved = float(np.std(after))
        ratio = f"{felt.std() / moved:.2g} times" if moved > 0.0 else "beside"
        sentences.append(
            f"g sin({name}) along {axis} varies by {felt.std():.2g} m/s² (standard deviation; mean "
            f"{mean:.2g}), {ratio} the motion's acceleration of {moved:.2g} m/s²"
        )
    if not sentences:
        return ""
    return (
        "the file holds the platform's angles, but the simulated IMU does not turn with it: "
        f"{'; '.join(sentences)}; so the advice holds for a levelled IMU only"
    )


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


def _explain_no_motion(recording: Recording) -> str:
    fixes = [recording.names[f"fix_{a}"] for a in "xy" if f"fix_{a}" in recording.names]
    if recording.has("acceleration"):
        return (
            f"{recording.path}: accelerations, but no position: for an IMU name its channels "
            "(columns.specific_force_x, _y) and fixes (columns.fix_x) or a reference "
            "(columns.reference_x); for a motion name its position (columns.position_x)"
        )
    if not fixes or recording.has("specific_force"):
        return f"{recording.path}: no position: set columns.position_x and columns.position_y"
    roles = " ".join(f"columns.position_{a}={n}" for a, n in zip("xy", fixes, strict=False))
    return (
        f"{recording.path}: fixes of a receiver ({', '.join(fixes)}), but no IMU beside them; "
        f"name its channels (columns.specific_force_x, _y), or, if they are the motion itself: "
        f"{shlex.join(['owtsweep', 'replay', str(recording.path)])} {roles}"
    )
