"""Use a recorded motion as a source of motion, in place of a simulated one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from owtsweep.errors import InputError
from owtsweep.motion.recorded.deriving import to_motion
from owtsweep.motion.recorded.recording import Recording
from owtsweep.motion.source import Motion


@dataclass(frozen=True)
class RecordedSource:
    """A source of the motion along x and y that a file holds; nothing in this motion is random.

    Attributes
    ----------
    recording
        A checked recording with positions.
    cutoff
        Frequency up to which the motion is kept, Hz. None stands for 5 Hz, or for 0.4 of the lower
        of two rates (of the recording and of the result) if this is less than 5 Hz.
    """

    recording: Recording
    cutoff: float | None = None
    streams: ClassVar[tuple[str, ...]] = ()

    @property
    def duration(self) -> float:
        """The time in s that the positions of all recorded axes cover; 0 without positions."""
        roles = [f"position_{axis}" for axis in "xy"]
        times = [self.recording.series(r)[0] for r in roles if r in self.recording.channels]
        if not times:
            return 0.0
        return float(min(time[-1] for time in times) - max(time[0] for time in times))

    def realise(
        self,
        stream: Callable[[str], np.random.Generator],
        *,
        steps: int,
        step: float,
        history: int = 0,
    ) -> Motion:
        """Return the first part of the recorded motion, resampled to the given sampling interval.

        Parameters
        ----------
        stream
            Not used, because nothing is random.
        steps, step
            Number of steps, and the length of a step in s.
        history
            Number of steps before t = 0, which delayed sensors need. The motion before t = 0 is
            taken from the beginning of the recording, so t = 0 is this many steps later.

        Raises
        ------
        InputError
            If the file has no positions or is too short.
        """
        gridded = to_motion(self.recording, 1.0 / step, cutoff=self.cutoff)
        available = gridded.grid.steps - history
        if steps > available:
            raise InputError(
                f"{self.recording.path}: holds {max(available, 0) * step:g} s of motion after the "
                f"{history * step:g} s that delayed sensors need, not {steps * step:g} s; ask for "
                "a shorter record or use a longer file"
            )
        whole = [gridded.pairs[name] for name in ("position", "velocity", "acceleration")]
        position, velocity, acceleration = (series[history : history + steps] for series in whole)
        return Motion(step, position, velocity, acceleration, whole[0][:history])
