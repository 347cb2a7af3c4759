"""Measure the errors of the baselines on a record: NONE, HOLD and DELTA.

Between two steps at which fixes are due, a baseline's estimate is a straight line, also where fixes
are missing: then it goes on with those that came.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.studies.hub.public import Line, Sensors
from owtsweep.studies.replay.measures import Measured, Tally
from owtsweep.studies.replay.record import ReplayRecord

#: Value of the column `scheme` -> name of the baseline, the simplest first. The values differ from
#: the names because NONE, HOLD and DELTA may also stand in the key `schemes`.
BASELINE_ROWS = {"no_estimate": "NONE", "last_fix": "HOLD", "last_two_fixes": "DELTA"}
#: Value of the column `scheme` -> the line from fix to fix that the baseline follows.
LINES = {
    "no_estimate": Line(holds=False, moves=False),
    "last_fix": Line(holds=True, moves=False),
    "last_two_fixes": Line(holds=True, moves=True),
}
#: The measures of baselines; HOLD has those of each axis too.
SHOWN = ("position", "velocity", "fix_residual")


def draw_lines(line: Line, fixes: Array, sensors: Sensors) -> tuple[Array, Array]:
    """Return positions (m) when fixes are due, and slopes (m/s), both (fixes, 2).

    fixes: (fixes, 2), m; NaN where none came. Before the first one the position is zero, before
        the second one the slope.
    """
    nothing = np.zeros_like(fixes)
    came = np.flatnonzero(np.isfinite(fixes[:, 0]))
    if not line.holds or len(came) == 0:
        return nothing, nothing
    here = np.arange(len(fixes))
    last = np.searchsorted(came, here, "right") - 1  # the number of the last fix that came, or -1
    held = np.where(last[:, None] >= 0, fixes[came[np.maximum(last, 0)]], 0.0)
    if not line.moves:
        return held, nothing
    slopes = np.zeros((len(came), 2))
    slopes[1:] = np.diff(fixes[came], axis=0) / (sensors.fix_step * np.diff(came))[:, None]
    slope = np.where(last[:, None] >= 0, slopes[np.maximum(last, 0)], 0.0)
    age = sensors.delay * sensors.step + sensors.fix_step * (here - came[np.maximum(last, 0)])
    return held + age[:, None] * slope, slope


def follow(
    line: Line, fixes: Array, sensors: Sensors, edges: Sequence[int]
) -> Iterator[Trajectory]:
    """Yield a baseline's estimates from each of the steps `edges` to the next."""
    start, slope = draw_lines(line, fixes, sensors)
    for begin, end in itertools.pairwise(edges):
        number, since = np.divmod(np.arange(begin, end), sensors.fix_interval)
        position = start[number] + (sensors.step * since)[:, None] * slope[number]
        yield Trajectory(np.concatenate([position, slope[number]], axis=1))


def measure_baselines(
    record: ReplayRecord, fixes: Array, sensors: Sensors, settled: int
) -> Iterator[tuple[str, Measured]]:
    """Yield the errors of the baselines in one replicate, each with its value of `scheme`.

    Arguments are those of `Tally`.
    """
    for row, line in LINES.items():
        tally = Tally(record, fixes, sensors, settled)
        for piece in follow(line, fixes, sensors, tally.edges):
            tally.add(piece)
        shown = (*SHOWN, "x", "y") if row == "last_fix" else SHOWN
        for measured in tally.measures():
            if measured[0] in shown:
                yield row, measured
