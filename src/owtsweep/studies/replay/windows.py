"""Choose the parts of a record that figures show."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.replay.record import ReplayRecord

#: Length of the longest "whole" view, s.
SPAN = 200.0
#: Zoomed view -> its length, s.
ZOOMS = {"zoom": 15.0, "acceleration": 6.0}
#: Zoomed views leave out this time at the start, while estimates settle, s.
SETTLING = 20.0


def choose_windows(record: ReplayRecord, positions: Iterable[Array]) -> dict[str, slice]:
    """Choose the parts of a record that figures show: name of the part -> its steps.

    The part "whole" begins with the record and is at most `SPAN` s long. The shorter parts "zoom"
    and "acceleration" lie around the largest motion after `SETTLING` s.

    Parameters
    ----------
    record
        The record.
    positions
        The positions in the record, true or estimated, in pieces of shape (n, 2) in m; NaN where
        unknown.
    """
    windows = {"whole": _select(record, record.begin, min(record.begin + SPAN, record.end))}
    for name, step in _find_largest_motion(record, positions).items():
        length = ZOOMS[name]
        start = max(record.begin + record.step * step - length / 2, record.begin)
        windows[name] = _select(record, start, min(start + length, record.end))
    return windows


def _find_largest_motion(record: ReplayRecord, positions: Iterable[Array]) -> dict[str, int]:
    """Find the step of the largest motion for each of the zoomed parts in `ZOOMS`: name -> step.

    A step is considered only if the zoomed part around this step lies inside the record and begins
    after `SETTLING` s. If there is no such step, the middle step of the record is taken.

    Parameters
    ----------
    record
        The record.
    positions
        The positions in the record, true or estimated, in pieces of shape (n, 2) in m; NaN where
        unknown.
    """
    found = dict.fromkeys(ZOOMS, (0.0, record.steps // 2))
    begin = 0
    for xy in positions:
        time = record.time_at(slice(begin, begin + len(xy)))
        size = np.where(np.isfinite(xy[:, 0]), np.hypot(xy[:, 0], xy[:, 1]), -1.0)
        for name, length in ZOOMS.items():
            first, last = record.begin + SETTLING + length / 2, record.end - length / 2
            here = np.where((time >= first) & (time <= last), size, -1.0)
            at = int(np.argmax(here))
            if here[at] > found[name][0]:
                found[name] = (float(here[at]), begin + at)
        begin += len(xy)
    return {name: step for name, (_, step) in found.items()}


def _select(record: ReplayRecord, start: float, end: float) -> slice:
    """Return the slice of the steps whose time lies from `start` to `end` (s), both included.

    Times are on the clock of the record's file.
    """
    near = slice(
        max(int((start - record.begin) / record.step) - 2, 0),
        min(int((end - record.begin) / record.step) + 3, record.steps),
    )
    time = record.time_at(near)
    inside = near.start + np.flatnonzero((time >= start) & (time <= end))
    return slice(int(inside[0]), int(inside[-1]) + 1)
