"""Which steps of a record its figures show."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.replay.measuring import PIECE
from owtsweep.studies.replay.record import Record

#: s that the whole and the zoomed views show at most.
SPAN, ZOOM, ACCELERATION_ZOOM = 200.0, 15.0, 6.0
#: s after the begin in which no view zooms in: estimates still settle.
SETTLING = 20.0


class Largest:
    """Where the motion is largest, for zoomed views of several lengths; told piece by piece."""

    def __init__(self, record: Record) -> None:
        self._record = record
        self._taken = 0
        self._found = dict.fromkeys((ZOOM, ACCELERATION_ZOOM), (0.0, -1))

    def add(self, position: Array) -> None:
        """Take the next positions, (n, 2) m; NaN where there is none."""
        for at in range(0, len(position), PIECE):
            self._add(position[at : at + PIECE])

    def _add(self, xy: Array) -> None:
        record, begin = self._record, self._taken
        self._taken += len(xy)
        time = record.time_at(slice(begin, self._taken))
        first, last = _ends(record)
        size = np.where(np.isfinite(xy[:, 0]), np.hypot(xy[:, 0], xy[:, 1]), -1.0)
        for length, (value, _) in self._found.items():
            inside = (time >= first + SETTLING + length / 2) & (time <= last - length / 2)
            here = np.where(inside, size, -1.0)
            at = int(np.argmax(here))
            if here[at] > value:
                self._found[length] = (float(here[at]), begin + at)

    def step(self, length: float) -> int:
        """The step of the largest motion, so far inside that a view of that length fits."""
        step = self._found[length][1]
        return step if step >= 0 else self._record.steps // 2


def windows(record: Record, largest: Largest) -> dict[str, slice]:
    """Name of a window -> its steps: "whole", "zoom" and "acceleration"."""
    first, last = _ends(record)
    found = {"whole": _within(record, first, min(first + SPAN, last))}
    for name, length in (("zoom", ZOOM), ("acceleration", ACCELERATION_ZOOM)):
        start, end = zoomed(record, largest.step(length), length)
        found[name] = _within(record, start, end)
    return found


def zoomed(record: Record, middle: int, length: float) -> tuple[float, float]:
    """Start and end (s) of a view of some length about a step."""
    first, last = _ends(record)
    centre = float(record.time_at(slice(middle, middle + 1))[0])
    start = max(centre - length / 2, first)
    return start, min(start + length, last)


def _ends(record: Record) -> tuple[float, float]:
    steps = record.steps
    return float(record.time_at(slice(0, 1))[0]), float(record.time_at(slice(steps - 1, steps))[0])


def _within(record: Record, start: float, end: float) -> slice:
    """The steps from start to end, s, both included."""
    near = slice(
        max(int((start - record.begin) / record.step) - 2, 0),
        min(int((end - record.begin) / record.step) + 3, record.steps),
    )
    time = record.time_at(near)
    inside = near.start + np.flatnonzero((time >= start) & (time <= end))
    return slice(int(inside[0]), int(inside[-1]) + 1)
