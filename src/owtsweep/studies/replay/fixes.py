"""Position fixes on the IMU's grid: recorded ones, and those made from a reference."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.studies.hub.public import Sensors, fix_count

#: A record with fewer fixes is refused.
LEAST_FIXES = 3


class Aligned(NamedTuple):
    """Recorded fixes, moved to the moments at which fixes are due.

    Attributes
    ----------
    offset
        Time of the first moment, s after the beginning of the record; less than one GNSS interval.
    values
        (fixes, 2) m, NaN where no fix came.
    jitter
        The largest time between a fix and its moment, s.
    dropped
        How many fixes were left out because another fix was nearer to the same moment.
    """

    offset: float
    values: Array
    jitter: float
    dropped: int


def align(time: Array, values: Array, duration: float, sensors: Sensors) -> Aligned:
    """Move irregular fixes to the grid of the GNSS, each to the nearest moment.

    The phase of the grid is the circular mean of the phases of the fixes, so the grid follows a
    constant offset of the fixes.

    Parameters
    ----------
    time
        (n,) times of the fixes, s after the beginning of the record.
    values
        (n, 2) m; rows with NaN are ignored.
    duration
        Duration of the record, s.

    Raises
    ------
    InputError
        If there are fewer than `LEAST_FIXES`.
    """
    came = np.all(np.isfinite(values), axis=1)
    time, values = time[came], values[came]
    if len(time) < LEAST_FIXES:
        raise InputError(
            f"columns.fix_x: the record holds {len(time)} position fixes, and {LEAST_FIXES} are "
            "needed; without fixes give a reference and replay.gnss=from_reference"
        )
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


def make_fixes(position: Array, first: int, steps: int, sensors: Sensors) -> Array:
    """Make fixes without noise: the reference `delay` steps before each moment, (fixes, 2) m.

    Parameters
    ----------
    position
        (n, 2) the reference in m on the IMU's grid, NaN in its gaps. It begins `first` steps
        before the first moment.
    first
        At least `sensors.delay`.
    steps
        IMU steps from the first moment on.
    """
    count = fix_count(steps, sensors.fix_interval)
    at = first - sensors.delay + sensors.fix_interval * np.arange(count)
    return np.array(position[at])
