"""From estimates to numbers: errors, coverage, consistency, and what needs no reference.

Without a reference a fix still tells how good an estimate was: the fix that arrives `delay` later
reports the position of that moment, and the estimate has not seen it. Their mean squared distance
is the MSE at those moments plus the variance of a fix, for every scheme alike.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

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


def measure(
    record: Record, fixes: Array, estimated: Estimated, sensors: Sensors, settled: int
) -> Iterator[Measured]:
    """All measures of one replicate.

    Parameters
    ----------
    record
        With its truth, if it has one.
    fixes
        (fixes, 2) as measured in this replicate.
    settled
        First settled step.
    """
    windows = {"full": 0, "settled": settled}
    if record.position is not None:
        yield from _errors(record, estimated, settled)
    residual = _fix_residual(fixes, estimated, sensors)
    for window, begin in windows.items():
        yield from _mean("fix_residual", window, residual[begin:])
        yield from _innovations(estimated, begin, window)
    yield from _parts("fix_residual", residual, settled)


def held(record: Record, fixes: Array, sensors: Sensors, settled: int) -> Iterator[Measured]:
    """The position error of holding the last fix: what an estimator has to beat."""
    if record.position is None:
        return
    last = np.where(np.isfinite(fixes[:, 0]), np.arange(len(fixes)), -1)
    last = np.maximum.accumulate(last)
    known = np.where(last[:, None] >= 0, fixes[np.maximum(last, 0)], 0.0)
    error = np.repeat(known, sensors.fix_interval, axis=0)[: record.steps] - record.position
    for window, begin in {"full": 0, "settled": settled}.items():
        squared = error[begin:] ** 2
        yield from _mean("x", window, squared[:, 0])
        yield from _mean("y", window, squared[:, 1])
        yield from _mean("position", window, squared.sum(axis=1))


def _errors(record: Record, estimated: Estimated, settled: int) -> Iterator[Measured]:
    """Errors and coverage over both windows and over the pieces of the settled one.

    They are summed piece by piece, so that a long record needs little memory besides itself.
    """
    edges = [0, *_edges(settled, record.steps)]
    pieces = [
        _sums(record, estimated, slice(begin, end)) for begin, end in itertools.pairwise(edges)
    ]
    for window, chosen in (("full", pieces), ("settled", pieces[1:])):
        for name in pieces[0]:
            count = sum(piece[name][1] for piece in chosen)
            if count:
                yield (name, window, sum(piece[name][0] for piece in chosen) / count, count)
    for number, piece in enumerate(pieces[1:]):
        for name in ("position", "velocity"):
            total, count = piece[name]
            if count:
                yield (name, f"part_{number:02d}", total / count, count)


def _sums(record: Record, estimated: Estimated, part: slice) -> dict[str, tuple[float, int]]:
    """Measure -> sum and number of its values where there is a truth."""
    truth = np.concatenate([record.given("position")[part], record.given("velocity")[part]], axis=1)
    error = estimated.state[part] - truth
    squared = error**2
    values = {name: squared[:, i] for i, name in enumerate(("x", "y", "vx", "vy"))}
    values["position"] = squared[:, 0] + squared[:, 1]
    values["velocity"] = squared[:, 2] + squared[:, 3]
    if estimated.covariance is not None:
        deviation = estimated.deviation_of(part)
        known = np.isfinite(squared) & np.isfinite(deviation)
        inside = np.where(known, squared <= (QUANTILE * deviation) ** 2, np.nan)
        values["coverage_position"] = inside[:, :2].ravel()
        values["coverage_velocity"] = inside[:, 2:].ravel()
        values["nees"] = _nees(error, estimated.covariance[part])
    sums = {}
    for name, series in values.items():
        there = np.isfinite(series)
        sums[name] = (float(np.sum(series[there])), int(np.count_nonzero(there)))
    return sums


def _nees(error: Array, P: Array) -> Array:
    """(n,) squared error in the metric of the covariance, both axes; error (n, 4)."""
    position, velocity = error[:, :2], error[:, 2:]
    pp, pv, vv = P[..., 0, 0], P[..., 0, 1], P[..., 1, 1]
    weighted = vv * position**2 - 2.0 * pv * position * velocity + pp * velocity**2
    return np.asarray(np.sum(weighted / (pp * vv - pv**2), axis=1))


def _innovations(estimated: Estimated, begin: int, window: str) -> Iterator[Measured]:
    if estimated.innovation is None or estimated.innovation_variance is None:
        return
    there = np.all(np.isfinite(estimated.innovation[begin:]), axis=1)
    innovation = estimated.innovation[begin:][there]
    variance = estimated.innovation_variance[begin:][there]
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


def _fix_residual(fixes: Array, estimated: Estimated, sensors: Sensors) -> Array:
    """(steps,) squared distance of the estimate from the fix that later tells of that moment."""
    steps, M = len(estimated.state), sensors.fix_interval
    residual = np.full(steps, np.nan)
    at = M * np.arange(len(fixes)) - sensors.delay
    there = (at >= 0) & (at < steps)
    if sensors.delay == 0:  # that fix has been seen; there is none to compare with
        return residual
    residual[at[there]] = np.sum((fixes[there] - estimated.state[at[there], :2]) ** 2, axis=1)
    return residual


def _edges(settled: int, steps: int) -> list[int]:
    return [int(edge) for edge in np.linspace(settled, steps, PARTS + 1)]


def _parts(name: str, values: Array, settled: int) -> Iterator[Measured]:
    for number, (begin, end) in enumerate(itertools.pairwise(_edges(settled, len(values)))):
        yield from _mean(name, f"part_{number:02d}", values[begin:end])


def _mean(name: str, window: str, values: Array) -> Iterator[Measured]:
    there = np.isfinite(values)
    count = int(np.count_nonzero(there))
    if count:
        yield (name, window, float(np.mean(values[there])), count)
