"""Make a record from recorded motion; the measurements are simulated later."""

from __future__ import annotations

from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import require
from owtsweep.errors import InputError
from owtsweep.motion.recorded import Gridded, Recording, to_motion
from owtsweep.studies.hub.public import Sensors, fix_count
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.leaning import describe_lean
from owtsweep.studies.replay.record import ReplayRecord


def make_record_of_motion(
    config: ReplayConfig, recording: Recording, sensors: Sensors
) -> ReplayRecord:
    """Make a record from recorded motion: motion resampled at the IMU's rate, and noiseless fixes.

    Raises
    ------
    InputError
        If the recording's rate is too low for the band of the spectrum, or the recording is shorter
        than the GNSS delay.
    """
    rate = config.sensors.imu.rate
    gridded = derive(recording, rate, cutoff=config.replay.cutoff)
    lowest = config.fit_band[0]
    kept = gridded.cutoff or 0.0
    require(
        kept > lowest,
        f"{recording.path}: frequencies of the motion are kept up to {kept:.3g} Hz only, but the "
        f"band begins at {lowest:g} Hz; check units.time, the record's rate, replay.cutoff and "
        "replay.band",
    )
    settling = config.measures.settling_time if config.measures.window == "settled" else 0.0
    lean = describe_lean(recording, gridded, settling)
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


def make_fixes(position: Array, first: int, steps: int, sensors: Sensors) -> Array:
    """Make position fixes without noise; return them with the shape (fixes, 2), in m.

    A fix reports the position `sensors.delay` steps before the fix arrives.

    Parameters
    ----------
    position
        The true position at every IMU step, shape (n, 2) in m; NaN in gaps.
    first
        The row of `position` at which the first fix arrives, at least `sensors.delay`.
    steps
        Number of IMU steps from the arrival of the first fix to the end.
    sensors
        The sensors' parameters.
    """
    count = fix_count(steps, sensors.fix_interval)
    at = first - sensors.delay + sensors.fix_interval * np.arange(count)
    return np.array(position[at])


def derive(recording: Recording, rate: float, **settings: Any) -> Gridded:
    """Resample recorded motion at `rate` (Hz), and compute its derivatives, by calling `to_motion`.

    `settings` are further arguments of `to_motion`.

    Raises
    ------
    InputError
        If `to_motion` refuses the recording. A message on its argument `cutoff` is changed, so that
        it names the file and the key replay.cutoff.
    """
    try:
        return to_motion(recording, rate, **settings)
    except InputError as error:
        if str(error).startswith("cutoff: "):
            raise InputError(f"{recording.path}: replay.{error}") from None
        raise
