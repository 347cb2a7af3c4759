"""Make a record from recorded motion; the measurements are simulated later."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import require
from owtsweep.errors import InputError
from owtsweep.gravity import GRAVITY
from owtsweep.motion.recorded import Gridded, Recording, to_motion
from owtsweep.motion.recorded.composing import LEAST
from owtsweep.studies.hub.public import Sensors, fix_count
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.record import ReplayRecord


def make_record_of_motion(
    config: ReplayConfig, recording: Recording, sensors: Sensors
) -> ReplayRecord:
    """Make a record from recorded motion: motion resampled at the IMU's rate, and noiseless fixes.

    Raises InputError if its rate is too low for the band, or it is shorter than the GNSS delay.
    """
    rate = config.sensors.imu.rate
    with blame_cutoff(recording):
        gridded = to_motion(recording, rate, cutoff=config.replay.cutoff)
    lowest = config.fit_band[0]
    kept = gridded.cutoff or 0.0
    require(
        kept > lowest,
        f"{recording.path}: frequencies of the motion are kept up to {kept:.3g} Hz only, but the "
        f"band begins at {lowest:g} Hz; check units.time, the record's rate, replay.cutoff and "
        "replay.band",
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


def make_fixes(position: Array, first: int, steps: int, sensors: Sensors) -> Array:
    """Make fixes without noise of positions (n, 2) at every IMU step, shape (fixes, 2), in m.

    The first arrives at the row `first`, at least `sensors.delay`, and tells of that delay before.
    """
    count = fix_count(steps, sensors.fix_interval)
    at = first - sensors.delay + sensors.fix_interval * np.arange(count)
    return np.array(position[at])


@contextmanager
def blame_cutoff(recording: Recording) -> Iterator[None]:
    """Name file and key in an `InputError` of `to_motion` on its argument `cutoff`."""
    try:
        yield
    except InputError as error:
        if str(error).startswith("cutoff: "):
            raise InputError(f"{recording.path}: replay.{error}") from None
        raise


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
