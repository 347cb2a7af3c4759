"""From estimates to numbers: errors, coverage, consistency, and what needs no reference.

Without a reference a fix still tells how good an estimate was: the fix that arrives `delay` later
reports the position of that moment, and the estimate has not seen it. Their mean squared distance
is the MSE at those moments plus the variance of a fix, for every scheme alike.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.replay.estimating import Estimated
from owtsweep.studies.replay.record import Record

WINDOWS = ("full", "settled")
#: The settled part in pieces, for the interval of a difference that was observed once.
PARTS = 20
#: Bound of a normal error that holds 95 %.
QUANTILE = 1.959963984540054
#: Lags of the whiteness test.
LAGS = 10

#: Measure, window, value, number of samples.
Measured = tuple[str, str, float, int]


class Tally:
    """All measures of one replicate, from its estimates piece by piece.

    Sums are those over whole pieces, so that any way of making the estimates gives the same.

    Parameters
    ----------
    record
        With its truth, if it has one.
    fixes
        (fixes, 2) as measured in this replicate.
    settled
        First settled step.
    """

    def __init__(self, record: Record, fixes: Array, sensors: Sensors, settled: int) -> None:
        self.record, self.settled = record, settled
        self.edges = edges(settled, record.steps)
        self._sums: list[dict[str, tuple[float, int]]] = []
        self._innovations: list[tuple[NDArray[np.int64], Array, Array]] = []
        self._taken = 0
        at = sensors.fix_interval * np.arange(len(fixes)) - sensors.delay
        # Without a delay that fix has been seen; there is none to compare with.
        told = (at >= 0) & (at < record.steps) & (sensors.delay > 0)
        self._told, self._fixes = at[told], fixes[told]
        self._residual = np.empty(len(self._told))

    def add(self, estimated: Estimated) -> None:
        """Take the next piece: the steps between two of `edges`."""
        begin = self._taken
        self._taken = end = begin + len(estimated.state)
        if (begin, end) != (self.edges[len(self._sums)], self.edges[len(self._sums) + 1]):
            raise ValueError(f"steps {begin} to {end} are no piece")
        self._sums.append(_sums(self.record, estimated, begin))
        own = slice(*np.searchsorted(self._told, [begin, end]))
        position = estimated.state[self._told[own] - begin, :2]
        self._residual[own] = np.sum((self._fixes[own] - position) ** 2, axis=1)
        there = np.flatnonzero(np.all(np.isfinite(estimated.innovation), axis=1))
        self._innovations.append(
            (begin + there, estimated.innovation[there], estimated.innovation_variance[there])
        )

    def measures(self) -> Iterator[Measured]:
        """All of them, once the last piece has been added."""
        if self._taken != self.record.steps:
            raise ValueError(f"{self._taken} of {self.record.steps} steps have been added")
        yield from _errors(self._sums)
        at, innovation, variance = map(np.concatenate, zip(*self._innovations, strict=True))
        for window, begin in {"full": 0, "settled": self.settled}.items():
            late = self._told >= begin
            yield from _mean("fix_residual", window, self._residual[late])
            yield from _innovations(innovation[at >= begin], variance[at >= begin], window)
        for number, (begin, end) in enumerate(itertools.pairwise(self.edges[1:])):
            inside = (self._told >= begin) & (self._told < end)
            yield from _mean("fix_residual", f"part_{number:02d}", self._residual[inside])


def measure(
    record: Record, fixes: Array, estimated: Estimated, sensors: Sensors, settled: int
) -> Iterator[Measured]:
    """All measures of one replicate whose estimates are there as a whole; see `Tally`."""
    tally = Tally(record, fixes, sensors, settled)
    for begin, end in itertools.pairwise(tally.edges):
        tally.add(estimated.part(slice(begin, end)))
    yield from tally.measures()


def held(record: Record, fixes: Array, sensors: Sensors, settled: int) -> Iterator[Measured]:
    """The position error of holding the last fix: what an estimator has to beat."""
    if record.position is None:
        return
    last = np.where(np.isfinite(fixes[:, 0]), np.arange(len(fixes)), -1)
    last = np.maximum.accumulate(last)
    known = np.where(last[:, None] >= 0, fixes[np.maximum(last, 0)], 0.0)
    squared = []  # axis by axis and in place: a long record leaves little room
    for axis in range(2):
        error = np.repeat(known[:, axis], sensors.fix_interval)[: record.steps]
        error -= record.position[:, axis]
        squared.append(np.square(error, out=error))
    both = squared[0] + squared[1]
    for window, begin in {"full": 0, "settled": settled}.items():
        yield from _mean("x", window, squared[0][begin:])
        yield from _mean("y", window, squared[1][begin:])
        yield from _mean("position", window, both[begin:])


def _errors(pieces: Sequence[dict[str, tuple[float, int]]]) -> Iterator[Measured]:
    """Errors and coverage over both windows and over the pieces of the settled one."""
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


def _sums(record: Record, estimated: Estimated, begin: int) -> dict[str, tuple[float, int]]:
    """Measure -> sum and number of its values where there is a truth; none without one.

    Axis by axis, in arrays that lie close together: this is where a replay spends its time.
    """
    if record.position is None:
        return {}
    part = slice(begin, begin + len(estimated.state))
    position, velocity = record.position[part], record.given("velocity")[part]
    squared: list[tuple[Array, Array]] = []
    nees: list[Array] = []
    inside = np.zeros((2, 2), dtype=np.int64)  # of position and of velocity: how many, of how many
    for axis in range(2):
        p = estimated.state[:, axis] - position[:, axis]
        v = estimated.state[:, 2 + axis] - velocity[:, axis]
        P = estimated.covariance[:, axis]
        pp, pv, vv = P[:, 0, 0], P[:, 0, 1], P[:, 1, 1]
        squared.append((p**2, v**2))
        nees.append(_nees(p, v, pp, pv, vv))
        for which, variance in enumerate((pp, vv)):
            limit = (QUANTILE * np.sqrt(variance)) ** 2
            known = np.isfinite(squared[axis][which]) & np.isfinite(limit)
            inside[which] += (
                np.count_nonzero((squared[axis][which] <= limit) & known),
                np.count_nonzero(known),
            )
    (x, vx), (y, vy) = squared
    series = {"x": x, "y": y, "vx": vx, "vy": vy, "position": x + y, "velocity": vx + vy}
    return {
        **{name: _total(values) for name, values in series.items()},
        "coverage_position": (float(inside[0, 0]), int(inside[0, 1])),
        "coverage_velocity": (float(inside[1, 0]), int(inside[1, 1])),
        "nees": _total(nees[0] + nees[1]),
    }


def _total(values: Array) -> tuple[float, int]:
    """Sum and number of what is finite."""
    there = np.isfinite(values)
    count = int(np.count_nonzero(there))
    return float(np.sum(values if count == len(values) else values[there])), count


def _nees(p: Array, v: Array, pp: Array, pv: Array, vv: Array) -> Array:
    """(n,) squared error of one axis in the metric of its covariance."""
    weighted = vv * p**2 - 2.0 * pv * p * v + pp * v**2
    return np.asarray(weighted / (pp * vv - pv**2))


def _innovations(innovation: Array, variance: Array, window: str) -> Iterator[Measured]:
    """NIS, size and whiteness of (n, 2) innovations."""
    if len(innovation) == 0:
        return
    yield from _mean("nis", window, np.sum(innovation**2 / variance, axis=1))
    yield from _mean("innovation", window, np.sum(innovation**2, axis=1))
    if len(innovation) > 2 * LAGS:
        scaled = innovation / np.sqrt(variance)
        lag_1, p = whiteness(scaled)
        yield ("innovation_lag_1", window, lag_1, len(innovation))
        yield ("innovation_white_p", window, p, len(innovation))


def whiteness(innovation: Array) -> tuple[float, float]:
    """Autocorrelation at lag 1 (mean of the axes) and the p value of Ljung and Box (1978).

    Q = n (n + 2) sum_k r_k^2 / (n - k) over `LAGS` lags, summed over the axes, is chi-squared with
    that many degrees of freedom if the innovations are white.

    Parameters
    ----------
    innovation
        (n, axes), no NaN.
    """
    from scipy.special import gammaincc

    n, axes = innovation.shape
    centred = innovation - innovation.mean(axis=0)
    power = np.sum(centred**2, axis=0)
    r = np.array([np.sum(centred[k:] * centred[:-k], axis=0) / power for k in range(1, LAGS + 1)])
    weight = n * (n + 2.0) / (n - np.arange(1.0, LAGS + 1.0))
    Q = float(np.sum(weight[:, None] * r**2))
    return float(np.mean(r[0])), float(gammaincc(0.5 * LAGS * axes, 0.5 * Q))


def edges(settled: int, steps: int) -> list[int]:
    """Where the pieces begin that are summed by themselves: the start, and `PARTS` settled ones."""
    return [0, *(int(edge) for edge in np.linspace(settled, steps, PARTS + 1))]


def _mean(name: str, window: str, values: Array) -> Iterator[Measured]:
    there = np.isfinite(values)
    count = int(np.count_nonzero(there))
    if count:
        yield (name, window, float(np.mean(values[there])), count)
