"""The interface of sources of motion, such as spectra and recorded files."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from owtsweep.arrays import Array
from owtsweep.streams import Streams


@dataclass(frozen=True)
class Motion:
    """One realisation of a motion, with positions before t = 0, which delayed sensors report.

    step: Sampling interval, s.
    position, velocity, acceleration: Series from t = 0 on, in m, m/s and m/s^2. Shape (steps,) for
        a motion along one direction, (steps, axes) for a motion along several axes.
    before: Positions before t = 0, oldest first, m; shape (history,) or (history, axes).
    felt: What an accelerometer on the structure feels of this motion, m/s^2, if that is more than
        the acceleration, because the structure leans; shape as `acceleration`, or None.
    """

    step: float
    position: Array
    velocity: Array
    acceleration: Array
    before: Array
    felt: Array | None = None

    @property
    def specific_force(self) -> Array:
        """What an accelerometer feels of the motion, m/s^2, in the shape of `acceleration`."""
        return self.acceleration if self.felt is None else self.felt

    def position_at(self, first: int, stride: int, count: int) -> Array:
        """Return `count` positions, at the steps first, first + stride, first + 2 stride, ...

        Steps are counted from t = 0; `first` may be negative. The result has shape (count,) or
        (count, axes); it is shorter if the record ends earlier. Raise `ValueError` if the record
        begins after the step `first`.
        """
        if first < -len(self.before):
            raise ValueError(
                f"the record holds {len(self.before)} steps before t = 0, not {-first}"
            )
        past = self.before[first + len(self.before) :: stride]
        return np.concatenate([past, self.position[first + len(past) * stride :: stride]])[:count]


class Source(Protocol):
    """The interface of a source of motion, such as a spectrum or a recorded file.

    All randomness of a realisation comes from the named random streams that `realise` is given.
    Therefore, two realisations with the same streams are equal bit by bit.

    streams: names of the random streams that the source draws from. If there are no names, all
        realisations are equal.
    duration: Duration in s of the longest record that the source can give, including the time
        before t = 0; None if the duration has no bound.
    """

    @property
    def streams(self) -> tuple[str, ...]: ...

    @property
    def duration(self) -> float | None: ...

    def realise(self, stream: Streams, *, steps: int, step: float, history: int = 0) -> Motion:
        """Return one realisation of the motion.

        Raise `InputError` if the source cannot give a record of this length; the message says what
        would work.

        stream: function that returns a new random generator, given the name of a random stream.
        steps, step: Number of samples and sampling interval (s) of the motion.
        history: Number of steps before t = 0 for which positions are needed: the longest delay of a
            sensor.
        """


@dataclass(frozen=True)
class DerivedSource:
    """A source of motion that is made of another: it has its random streams and its duration."""

    source: Source

    @property
    def streams(self) -> tuple[str, ...]:
        return self.source.streams

    @property
    def duration(self) -> float | None:
        return self.source.duration
