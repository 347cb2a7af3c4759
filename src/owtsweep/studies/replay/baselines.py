"""Measure the errors of the baselines on a record: NONE, HOLD and DELTA.

Between two steps at which fixes are due, the estimate of a baseline is a straight line
(`hub.lines`). Its squared error is a polynomial in few sums over the true motion. These sums are
made once per record, so another draw of the noise costs as much time as there are fixes, not as
there are steps. Fixes may be missing; a baseline then goes on with those that came.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.studies.hub.public import Line, Sensors
from owtsweep.studies.replay.measures import Measured, cut_into_parts, measure_last_fix
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


@dataclass(frozen=True)
class Lines:
    """The estimates of a baseline: a straight line for each interval from one due fix to the next.

    `start` (m), when the interval begins, and `slope` (m/s) have the shape (intervals, 2).
    """

    start: Array
    slope: Array


def draw_lines(line: Line, fixes: Array, sensors: Sensors) -> Lines:
    """Return the estimates of a baseline that follows `line`.

    Fixes are in m, shape (intervals, 2); NaN where none came. Before the first fix, the position is
    zero; before the second fix, the velocity is zero.
    """
    nothing = np.zeros_like(fixes)
    came = np.flatnonzero(np.isfinite(fixes[:, 0]))
    if not line.holds or len(came) == 0:
        return Lines(nothing, nothing)
    here = np.arange(len(fixes))
    last = np.searchsorted(came, here, "right") - 1  # the number of the last fix that came, or -1
    held = np.where(last[:, None] >= 0, fixes[came[np.maximum(last, 0)]], 0.0)
    if not line.moves:
        return Lines(held, nothing)
    slopes = np.zeros((len(came), 2))
    slopes[1:] = np.diff(fixes[came], axis=0) / (sensors.fix_step * np.diff(came))[:, None]
    slope = np.where(last[:, None] >= 0, slopes[np.maximum(last, 0)], 0.0)
    age = sensors.delay * sensors.step + sensors.fix_step * (here - came[np.maximum(last, 0)])
    return Lines(held + age[:, None] * slope, slope)


@dataclass(frozen=True)
class MotionSums:
    """Sums over the true motion in segments of a record, which lie within one interval each.

    interval: the number of the interval between due fixes in which a segment lies, shape
        (segments,).
    part: the number of the piece of the record in which a segment lies, shape (segments,): 0 before
        the settling time, then 1 and so on.
    counts: Number of steps with a known position, and sums over these of the time since the
        interval began (s) and its square (s^2), shape (3, segments).
    position: Sums of the displacement (m), of the displacement times that time (m s), and of the
        squared displacement (m^2), shape (3, segments, 2).
    velocity: Sums of the velocity (m/s) and of its square (m^2/s^2), shape (2, segments, 2).
    known: Number of steps with a known velocity, shape (segments,).
    """

    interval: NDArray[np.intp]
    part: NDArray[np.intp]
    counts: Array
    position: Array
    velocity: Array
    known: Array


def sum_motion(record: ReplayRecord, sensors: Sensors, settled: int) -> MotionSums | None:
    """Sum the true motion of a record, if known, segment by segment.

    `settled` is the first step after the settling time.
    """
    if record.position is None:
        return None
    position, velocity = record.position, record.given("velocity")
    M = sensors.fix_interval
    found: list[tuple[Array, ...]] = []
    for part, (begin, end) in enumerate(itertools.pairwise(cut_into_parts(settled, record.steps))):
        if begin == end:
            continue
        starts = np.unique([begin, *range(-(-begin // M) * M, end, M)])
        time = sensors.step * (np.arange(begin, end) % M)
        p, v = position[begin:end], velocity[begin:end]
        there, moving = np.isfinite(p[:, 0]), np.isfinite(v[:, 0])
        p, v = np.where(there[:, None], p, 0.0), np.where(moving[:, None], v, 0.0)
        weight = there.astype(float)
        at = starts - begin
        found.append(
            (
                starts // M,
                np.full(len(starts), part),
                np.add.reduceat(np.stack([weight, weight * time, weight * time**2]), at, axis=1),
                np.stack([np.add.reduceat(q, at) for q in (p, p * time[:, None], p**2)]),
                np.stack([np.add.reduceat(q, at) for q in (v, v**2)]),
                np.add.reduceat(moving.astype(float), at),
            )
        )
    interval, parts, counts, positions, velocities, known = zip(*found, strict=True)
    return MotionSums(
        np.concatenate(interval),
        np.concatenate(parts),
        np.concatenate(counts, axis=1),
        np.concatenate(positions, axis=1),
        np.concatenate(velocities, axis=1),
        np.concatenate(known),
    )


def measure_baselines(
    record: ReplayRecord, sums: MotionSums | None, fixes: Array, sensors: Sensors, settled: int
) -> Iterator[tuple[str, Measured]]:
    """Yield the errors of the baselines in one replicate, each with its value of `scheme`.

    The measures are "position", "velocity" and "fix_residual" in the windows of a scheme: "full",
    "settled", "part_00" and so on. HOLD has "x" and "y" too. Fixes are in m, shape (fixes, 2); NaN
    where none came. `settled` is the first step after the settling time.
    """
    for row, line in LINES.items():
        lines = draw_lines(line, fixes, sensors)
        stands = line.holds and not line.moves
        if stands:  # the whole windows as stored replays have them, to the last digit
            for measured in measure_last_fix(record, fixes, sensors, settled):
                yield row, measured
        if sums is not None:
            for quantity, (squared, count) in _sum_errors(lines, sums).items():
                parts = np.array([np.bincount(sums.part, q) for q in (squared, count)], dtype=float)
                for measured in _average(quantity, parts):
                    if not stands or quantity != "position" or measured[1].startswith("part_"):
                        yield row, measured
        residual = _sum_residuals(lines, fixes, sensors, cut_into_parts(settled, record.steps))
        for measured in _average("fix_residual", residual):
            yield row, measured


def _sum_errors(lines: Lines, sums: MotionSums) -> dict[str, tuple[Array, Array]]:
    """Return squared errors, summed within segments, and the numbers of steps: both (segments,)."""
    start, slope = lines.start[sums.interval], lines.slope[sums.interval]
    n, t, tt = (row[:, None] for row in sums.counts)
    p, pt, pp = sums.position
    v, vv = sums.velocity
    position = n * start**2 + 2.0 * t * start * slope + tt * slope**2
    position += pp - 2.0 * (start * p + slope * pt)
    velocity = sums.known[:, None] * slope**2 - 2.0 * slope * v + vv
    return {
        "position": (np.maximum(position.sum(axis=1), 0.0), sums.counts[0]),
        "velocity": (np.maximum(velocity.sum(axis=1), 0.0), sums.known),
    }


def _sum_residuals(lines: Lines, fixes: Array, sensors: Sensors, edges: list[int]) -> Array:
    """Sum squared distances between fixes and the earlier estimates for the times of the fixes.

    Return sums (m^2) and numbers of fixes in each piece of the record, shape (2, pieces).
    """
    at = sensors.fix_interval * np.arange(len(fixes)) - sensors.delay
    # Without a delay the estimate has already used the fix of the same time.
    judged = (at >= 0) & (at < edges[-1]) & np.isfinite(fixes[:, 0]) & (sensors.delay > 0)
    at, number = at[judged], at[judged] // sensors.fix_interval
    since = sensors.step * (at % sensors.fix_interval)
    estimate = lines.start[number] + since[:, None] * lines.slope[number]
    squared = np.sum((fixes[judged] - estimate) ** 2, axis=1)
    part = np.searchsorted(edges[1:], at, "right")
    count = len(edges) - 1
    return np.stack([np.bincount(part, w, count) for w in (squared, np.ones(len(at)))])


def _average(name: str, parts: Array) -> Iterator[Measured]:
    """Yield averages over the windows of a record; `parts` are sums and counts, (2, pieces)."""
    windows = {"full": parts, "settled": parts[:, 1:]}
    windows |= {f"part_{i:02d}": parts[:, i + 1 : i + 2] for i in range(parts.shape[1] - 1)}
    for window, (total, count) in windows.items():
        if np.sum(count) > 0.0:
            yield (name, window, float(np.sum(total) / np.sum(count)), int(np.sum(count)))
