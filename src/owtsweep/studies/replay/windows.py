"""Choose the steps of a record that its figures show."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.replay.measuring import PIECE
from owtsweep.studies.replay.record import ReplayRecord

#: Length of the longest "whole" view, and lengths of the zoomed views, s.
SPAN, ZOOM, ACCELERATION_ZOOM = 200.0, 15.0, 6.0
#: Zoomed views leave out this time at the start, while estimates settle, s.
SETTLING = 20.0


class LargestMotion:
    """Finds the step of largest motion, piece by piece, for zoomed views of several lengths."""

    def __init__(self, record: ReplayRecord) -> None:
        self._record = record
        self._added = 0
        self._largest = dict.fromkeys((ZOOM, ACCELERATION_ZOOM), (0.0, -1))

    def add(self, position: Array) -> None:
        """Take the next positions, (n, 2) m; NaN where there is none."""
        for at in range(0, len(position), PIECE):
            self._add(position[at : at + PIECE])

    def _add(self, xy: Array) -> None:
        record, begin = self._record, self._added
        self._added += len(xy)
        time = record.time_at(slice(begin, self._added))
        first, last = _ends(record)
        size = np.where(np.isfinite(xy[:, 0]), np.hypot(xy[:, 0], xy[:, 1]), -1.0)
        for length, (value, _) in self._largest.items():
            inside = (time >= first + SETTLING + length / 2) & (time <= last - length / 2)
            here = np.where(inside, size, -1.0)
            at = int(np.argmax(here))
            if here[at] > value:
                self._largest[length] = (float(here[at]), begin + at)

    def step(self, length: float) -> int:
        """The step of largest motion around which a view of that length fits."""
        step = self._largest[length][1]
        return step if step >= 0 else self._record.steps // 2


def choose_windows(record: ReplayRecord, largest: LargestMotion) -> dict[str, slice]:
    """Name of a window -> its steps: "whole", "zoom" and "acceleration"."""
    first, last = _ends(record)
    windows = {"whole": _select(record, first, min(first + SPAN, last))}
    for name, length in (("zoom", ZOOM), ("acceleration", ACCELERATION_ZOOM)):
        start, end = choose_zoom(record, largest.step(length), length)
        windows[name] = _select(record, start, end)
    return windows


def choose_zoom(record: ReplayRecord, middle: int, length: float) -> tuple[float, float]:
    """Start and end (s) of a view of a length (s) around a step."""
    first, last = _ends(record)
    centre = float(record.time_at(slice(middle, middle + 1))[0])
    start = max(centre - length / 2, first)
    return start, min(start + length, last)


def _ends(record: ReplayRecord) -> tuple[float, float]:
    steps = record.steps
    return float(record.time_at(slice(0, 1))[0]), float(record.time_at(slice(steps - 1, steps))[0])


def _select(record: ReplayRecord, start: float, end: float) -> slice:
    """The steps from start to end (s), both included."""
    near = slice(
        max(int((start - record.begin) / record.step) - 2, 0),
        min(int((end - record.begin) / record.step) + 3, record.steps),
    )
    time = record.time_at(near)
    inside = near.start + np.flatnonzero((time >= start) & (time <= end))
    return slice(int(inside[0]), int(inside[-1]) + 1)
