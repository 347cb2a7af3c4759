"""Measure estimates: errors, coverage, consistency, and distances to later fixes.

Without a reference position, an estimate is compared with the fix that arrives one GNSS delay later
and reports the same moment; the estimate has not used it. The mean squared distance is its MSE plus
the variance of a fix, which is equal for all schemes.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.studies.hub.public import Sensors
from owtsweep.studies.replay.record import ReplayRecord

WINDOWS = ("full", "settled")
#: Number of parts of the settled record. With a single replicate their spread gives intervals.
PARTS = 20
#: 95 % of normal errors lie within this many standard deviations.
QUANTILE = 1.959963984540054
#: Number of lags in the whiteness test.
LAGS = 10

#: Measure, window, value, number of samples.
Measured = tuple[str, str, float, int]


class Tally:
    """All measures of a scheme in one replicate, from its estimates piece by piece.

    Pieces always begin and end at the steps of `cut_into_parts`, so sums are equal to the last bit.

    record: the record, with the true motion if it is known.
    fixes: those of this replicate, shape (fixes, 2) in m; NaN where no fix came.
    settled: the first step after the settling time.
    """

    def __init__(self, record: ReplayRecord, fixes: Array, sensors: Sensors, settled: int) -> None:
        self.record, self.settled = record, settled
        self.edges = cut_into_parts(settled, record.steps)
        self._sums: list[dict[str, tuple[float, int]]] = []
        nothing = np.empty((0, 2))
        self._innovations: list[tuple[NDArray[np.int64], Array, Array]] = [
            (np.empty(0, dtype=np.int64), nothing, nothing)
        ]
        reported = sensors.fix_interval * np.arange(len(fixes)) - sensors.delay
        # Without a delay the estimate has already used the fix of the same time.
        judged = (reported >= 0) & (reported < record.steps) & (sensors.delay > 0)
        self._reported, self._fixes = reported[judged], fixes[judged]
        self._residual = np.empty(len(self._reported))

    def add(self, estimated: Trajectory) -> None:
        """Add the estimates of the next piece: the steps between two neighbours of `self.edges`."""
        begin, end = self.edges[len(self._sums) : len(self._sums) + 2]
        self._sums.append(_sum_errors(self.record, estimated, begin))
        inside = slice(*np.searchsorted(self._reported, [begin, end]))
        position = estimated.state[self._reported[inside] - begin, :2]
        self._residual[inside] = np.sum((self._fixes[inside] - position) ** 2, axis=1)
        innovation, covariance = estimated.innovation, estimated.innovation_covariance
        if innovation is not None and covariance is not None:
            at = np.flatnonzero(np.all(np.isfinite(innovation), axis=1))
            variance = np.einsum("kii->ki", covariance[at])
            self._innovations.append((begin + at, innovation[at], variance))

    def measures(self) -> Iterator[Measured]:
        """Yield all as (measure, window, value, number of samples), after the last piece."""
        yield from _average_errors(self._sums)
        at, innovation, variance = map(np.concatenate, zip(*self._innovations, strict=True))
        for window, begin in {"full": 0, "settled": self.settled}.items():
            late = self._reported >= begin
            yield from _average("fix_residual", window, self._residual[late])
            yield from _judge_innovations(innovation[at >= begin], variance[at >= begin], window)
        for number, (begin, end) in enumerate(itertools.pairwise(self.edges[1:])):
            inside = (self._reported >= begin) & (self._reported < end)
            yield from _average("fix_residual", f"part_{number:02d}", self._residual[inside])


def _average_errors(pieces: Sequence[dict[str, tuple[float, int]]]) -> Iterator[Measured]:
    for window, chosen in (("full", pieces), ("settled", pieces[1:])):
        for name in pieces[0]:
            count = sum(piece[name][1] for piece in chosen)
            if count:
                yield (name, window, sum(piece[name][0] for piece in chosen) / count, count)
    for number, piece in enumerate(pieces[1:]):
        for name in ("position", "velocity"):
            total, count = piece.get(name, (0.0, 0))
            if count:
                yield (name, f"part_{number:02d}", total / count, count)


def _sum_errors(
    record: ReplayRecord, estimated: Trajectory, begin: int
) -> dict[str, tuple[float, int]]:
    """Sum squared errors and NEES over a piece; count errors within ±1.96 standard deviations."""
    if record.position is None:
        return {}
    part = slice(begin, begin + len(estimated.state))
    position, velocity = record.position[part], record.given("velocity")[part]
    squared: list[tuple[Array, Array]] = []
    nees: list[Array] = []
    inside = np.zeros((2, 2), dtype=np.int64)  # (position, velocity) x (inside, judged)
    for axis in range(2):
        p = estimated.state[:, axis] - position[:, axis]
        v = estimated.state[:, 2 + axis] - velocity[:, axis]
        squared.append((p**2, v**2))
        if estimated.covariance is None:
            continue
        P = estimated.axis_covariance(axis)
        pp, pv, vv = P[:, 0, 0], P[:, 0, 1], P[:, 1, 1]
        nees.append(_weigh(p, v, pp, pv, vv))
        for which, variance in enumerate((pp, vv)):
            limit = (QUANTILE * np.sqrt(variance)) ** 2
            judged = np.isfinite(squared[axis][which]) & np.isfinite(limit)
            inside[which] += (
                np.count_nonzero((squared[axis][which] <= limit) & judged),
                np.count_nonzero(judged),
            )
    (x, vx), (y, vy) = squared
    series = {"x": x, "y": y, "vx": vx, "vy": vy, "position": x + y, "velocity": vx + vy}
    return {
        **{name: _sum_finite(values) for name, values in series.items()},
        "coverage_position": (float(inside[0, 0]), int(inside[0, 1])),
        "coverage_velocity": (float(inside[1, 0]), int(inside[1, 1])),
        "nees": _sum_finite(nees[0] + nees[1]) if nees else (0.0, 0),
    }


def _sum_finite(values: Array) -> tuple[float, int]:
    finite = np.isfinite(values)
    count = int(np.count_nonzero(finite))
    return float(np.sum(values if count == len(values) else values[finite])), count


def _weigh(p: Array, v: Array, pp: Array, pv: Array, vv: Array) -> Array:
    weighted = vv * p**2 - 2.0 * pv * p * v + pp * v**2
    return np.asarray(weighted / (pp * vv - pv**2))


def _judge_innovations(innovation: Array, variance: Array, window: str) -> Iterator[Measured]:
    if len(innovation) == 0:
        return
    yield from _average("nis", window, np.sum(innovation**2 / variance, axis=1))
    yield from _average("innovation", window, np.sum(innovation**2, axis=1))
    if len(innovation) > 2 * LAGS:
        scaled = innovation / np.sqrt(variance)
        lag_1, p = check_whiteness(scaled)
        yield ("innovation_lag_1", window, lag_1, len(innovation))
        yield ("innovation_white_p", window, p, len(innovation))


def check_whiteness(innovation: Array) -> tuple[float, float]:
    """Test whether innovations, (n, axes) without NaN, are white, by Ljung and Box (1978).

    Q = sum of n (n + 2) r_k^2 / (n - k) over `LAGS` lags k and the axes, r_k being the
    autocorrelation, is then chi-squared. Return r_1 (mean over the axes), and the p-value.
    """
    from scipy.special import gammaincc

    n, axes = innovation.shape
    centred = innovation - innovation.mean(axis=0)
    power = np.sum(centred**2, axis=0)
    r = np.array([np.sum(centred[k:] * centred[:-k], axis=0) / power for k in range(1, LAGS + 1)])
    weight = n * (n + 2.0) / (n - np.arange(1.0, LAGS + 1.0))
    Q = float(np.sum(weight[:, None] * r**2))
    return float(np.mean(r[0])), float(gammaincc(0.5 * LAGS * axes, 0.5 * Q))


def cut_into_parts(settled: int, steps: int) -> list[int]:
    """Return the edges of a record's parts: up to `settled`, then `PARTS` equal ones."""
    return [0, *(int(edge) for edge in np.linspace(settled, steps, PARTS + 1))]


def _average(name: str, window: str, values: Array) -> Iterator[Measured]:
    total, count = _sum_finite(values)
    if count:
        yield (name, window, total / count, count)
