"""Where motion comes from: a spectrum, a recorded file, or anything else that gives `Motion`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from owtsweep.arrays import Array


@dataclass(frozen=True)
class Motion:
    """One realisation of a motion, with the past positions that delayed measurements report.

    Along one direction all series are (steps,); along several axes (steps, axes).

    Attributes
    ----------
    step
        Sampling interval, s.
    position, velocity, acceleration
        (steps,) or (steps, axes) in m, m/s, m/s^2, from t = 0.
    before
        (history,) or (history, axes) positions before t = 0, oldest first, m.
    """

    step: float
    position: Array
    velocity: Array
    acceleration: Array
    before: Array

    def position_at(self, first: int, stride: int, count: int) -> Array:
        """The `count` positions at steps first, first + stride, ...; `first` may be negative.

        Raises
        ------
        ValueError
            If the record does not reach that far back.
        """
        if first < -len(self.before):
            raise ValueError(
                f"the record holds {len(self.before)} steps before t = 0, not {-first}"
            )
        earlier = min(max(-(first // stride), 0), count)  # how many of them are before t = 0
        past = self.before[first + len(self.before) :: stride][:earlier]
        return np.concatenate([past, self.position[first + earlier * stride :: stride]])[:count]


@runtime_checkable
class Source(Protocol):
    """A source of motion: the interface that studies use.

    All randomness in a realisation comes from the named streams that `realise` takes. So two
    realisations with the same streams are equal bit by bit.

    Attributes
    ----------
    streams
        Names of the random streams that it draws from. Without any, all realisations are equal.
    duration
        Longest record that it can give, s, together with its history; None if there is no bound.
    """

    @property
    def streams(self) -> tuple[str, ...]: ...

    @property
    def duration(self) -> float | None: ...

    def realise(
        self,
        stream: Callable[[str], np.random.Generator],
        *,
        steps: int,
        step: float,
        history: int = 0,
    ) -> Motion:
        """Give one realisation.

        Parameters
        ----------
        stream
            Gives a fresh random generator for a name.
        steps, step
            Number of samples and sampling interval (s), those of the fastest sensor.
        history
            For how many steps before t = 0 positions are needed: the longest delay of a sensor.

        Raises
        ------
        InputError
            If it cannot give such a record; the message says what would work.
        """
        ...
