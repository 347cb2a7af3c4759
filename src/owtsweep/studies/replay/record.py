"""The record of a replay: a recording at the IMU's rate, from the first moment a fix is due."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.freed_memory import give_back_freed_memory

#: Steps beyond which a record is long: its memory is watched, and slow work is announced.
LONG = 1_000_000


@dataclass(frozen=True, kw_only=True)
class ReplayRecord:
    """A record for a replay: series in SI units and NED coordinates, with one row per IMU step.

    Attributes
    ----------
    file
        The file from which the record was read.
    gnss
        Where the position fixes come from: "simulated" for recorded motion; "recorded" or
        "from_reference" for recorded sensors.
    begin, step, steps
        Time of step 0 on the file's clock (s), length of a step (s), and number of IMU steps.
    origin
        Offset that has been subtracted from all positions, shape (2,) in m.
    position, velocity
        The true position (m) and velocity (m/s), shape (steps, 2); NaN in gaps, None if unknown.
    acceleration
        The true acceleration (m/s^2), shape (steps, 2); None for recorded sensors.
    specific_force
        The recorded specific force (m/s^2) in the IMU's frame, shape (steps, 2); None for recorded
        motion.
    fixes
        Position fixes (m) as recorded, or made without noise, shape (fixes, 2); NaN where no fix
        came.
    truth
        The source of the true position, in words; "" if the position is unknown.
    notes
        What the user should know about the recording, one sentence each.
    lean
        What a level IMU leaves out where a platform turns, one sentence; "" if nothing.
    """

    file: str
    gnss: str
    begin: float
    step: float
    steps: int
    origin: Array
    position: Array | None = None
    velocity: Array | None = None
    acceleration: Array | None = None
    specific_force: Array | None = None
    fixes: Array
    truth: str
    notes: tuple[str, ...]
    lean: str = ""

    @property
    def end(self) -> float:
        """The time of the last step on the file's clock, in s."""
        return self.begin + self.step * (self.steps - 1)

    def time_at(self, part: slice) -> Array:
        """Return the times of the steps in a slice, on the file's clock, in s."""
        return np.asarray(self.begin + self.step * np.arange(*part.indices(self.steps)))

    @property
    def nbytes(self) -> int:
        """The size of all series in bytes."""
        series = (self.position, self.velocity, self.acceleration, self.specific_force, self.fixes)
        return sum(0 if one is None else one.nbytes for one in series)

    def given(self, name: str) -> Array:
        """Return the series called `name`, e.g. "velocity"; raise TypeError if there is none."""
        series: Array | None = getattr(self, name)
        if series is None:
            raise TypeError(f"{self.file}: the record has no {name}")
        return series


def release_memory(record: ReplayRecord) -> None:
    """Give freed memory back to the operating system, if the record has more than `LONG` steps.

    This is some 100 MB.
    """
    if record.steps > LONG:
        give_back_freed_memory()
