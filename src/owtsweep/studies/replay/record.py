"""A recording on the IMU's grid, from the first moment at which a fix is due."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.freed_memory import give_back_freed_memory

#: Steps beyond which a record is long: its memory is watched, and slow work is announced.
LONG = 1_000_000


@dataclass(frozen=True, kw_only=True)
class ReplayRecord:
    """A record for a replay: series in NED relative to the origin, SI units.

    Attributes
    ----------
    file
        The file that it was read from.
    gnss
        Where the fixes come from: "simulated" (motion), "recorded" or "from_reference" (sensors).
    begin, step, steps
        Time of step 0 on the file's clock (s), interval (s), and number of IMU steps.
    origin
        (2,) offset subtracted from the positions, m.
    position, velocity
        (steps, 2) the truth; NaN in gaps of a reference, None without a reference.
    acceleration
        (steps, 2), for recorded motion.
    specific_force
        (steps, 2) in the IMU's frame, for recorded sensors.
    fixes
        (fixes, 2) as recorded, or made without noise; NaN where there is no fix.
    truth
        The source of the truth, in words.
    notes
        What the user should know about the recording, one sentence each.
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

    @property
    def end(self) -> float:
        """Time of the last step, s, on the file's clock."""
        return self.begin + self.step * (self.steps - 1)

    def time_at(self, part: slice) -> Array:
        """Times of some steps, s, on the file's clock."""
        return np.asarray(self.begin + self.step * np.arange(*part.indices(self.steps)))

    @property
    def nbytes(self) -> int:
        """Size of all series in bytes."""
        series = (self.position, self.velocity, self.acceleration, self.specific_force, self.fixes)
        return sum(0 if one is None else one.nbytes for one in series)

    def given(self, name: str) -> Array:
        """The series of a name; it must not be None."""
        series: Array | None = getattr(self, name)
        if series is None:
            raise TypeError(f"{self.file}: the record has no {name}")
        return series


def release_memory(record: ReplayRecord) -> None:
    """Return freed memory (some 100 MB) to the system after the pieces of a long record."""
    if record.steps > LONG:
        give_back_freed_memory()
