"""Say what a level IMU leaves out where a platform turns: gravity along its leaning axes."""

from __future__ import annotations

import numpy as np

from owtsweep.gravity import GRAVITY
from owtsweep.motion.recorded import Gridded, Recording
from owtsweep.motion.recorded.composing import LEAST


def describe_lean(recording: Recording, gridded: Gridded, begin: float) -> str:
    """Say how large g sin(pitch) and g sin(roll) are beside the motion's acceleration.

    Compared are standard deviations, from `begin` (s) after the motion's start on. The mean is told
    but not compared: a constant lean is a constant bias of the accelerometer, which schemes
    estimate; what changes cannot be told from motion. Returns "" if no platform turns.
    """
    told = []
    start = gridded.grid.start + begin
    for axis, (name, angle) in recording.leans.items():
        if f"position_{axis}" not in recording.channels:
            continue
        if angle is None:
            told.append(f"g sin({name}) along {axis} is not known, as {name} has no unit of angle")
            continue
        there = angle[np.isfinite(angle) & (recording.time >= start)]
        if len(there) == 0 or np.ptp(there) <= LEAST["angle"]:
            continue
        felt = GRAVITY * np.sin(there)
        mean = round(float(felt.mean()), 4) + 0.0  # no -0, and no 1e-18
        after = gridded.pairs["acceleration"][round(begin * gridded.grid.rate) :, "xy".index(axis)]
        moved = float(np.std(after))
        ratio = f"{felt.std() / moved:.2g} times" if moved > 0.0 else "beside"
        told.append(
            f"g sin({name}) along {axis} varies by {felt.std():.2g} m/s² (standard deviation; mean "
            f"{mean:.2g}), {ratio} the motion's acceleration of {moved:.2g} m/s²"
        )
    if not told:
        return ""
    return (
        "the file holds the platform's angles, but the simulated IMU does not turn with it: "
        f"{'; '.join(told)}; so the advice holds for a levelled IMU only"
    )
