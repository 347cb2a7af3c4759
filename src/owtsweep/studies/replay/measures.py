"""Measure estimates of schemes and baselines: errors, coverage, distances to later fixes.

Without a reference position, an estimate is compared with the fix that arrives one GNSS delay later
and reports the same moment; the estimate has not used it. A fix without delay is compared with the
estimate of the IMU step before it, carried on by its own velocity. The mean squared distance is the
MSE plus the variance of a fix, which is equal for all schemes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

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

#: Value of the column `scheme` -> name of the baseline, the simplest first. The values differ from
#: the names because NONE, HOLD and DELTA may also stand in the key `schemes`.
BASELINE_ROWS = {"no_estimate": "NONE", "last_fix": "HOLD", "last_two_fixes": "DELTA"}
#: Value of the column `scheme` of rows on a record's noise, and the measure of innovations that are
#: not Gaussian: their excess kurtosis.
NOISE, TAILS = "noise_of_record", "excess_kurtosis"
#: Values of the column `noise` of the advice: the noise with which schemes ran.
STATED, ESTIMATED = "stated", "estimated"
#: The measures of the parts, and of baselines; HOLD has those of each axis too.
SHOWN = ("position", "velocity", "fix_residual")
#: Measure, window, value, number of samples.
Measured = tuple[str, str, float, int]


def name_second_run(scheme: str) -> str:
    """Return the name, in rows of results, of a scheme that was run with the estimated noise."""
    return f"{scheme} (estimated noise)"


def find_judging_steps(fixes: int, sensors: Sensors) -> NDArray[np.int64]:
    """Return for each fix the step whose estimate is compared with it, shape (fixes,)."""
    return sensors.fix_interval * np.arange(fixes) - max(sensors.delay, 1)


def foresee_fixes(state: Array, sensors: Sensors) -> Array:
    """Return what a state (n, 4) at the steps of `find_judging_steps` says of fixes, m, (n, 2)."""
    if sensors.delay > 0:
        return np.asarray(state[:, :2])
    return np.asarray(state[:, :2] + sensors.step * state[:, 2:])


class Tally:
    """All measures of a scheme in one replicate, from its estimates piece by piece.

    Pieces always begin and end at the steps of `cut_into_parts`, so sums are equal to the last bit.

    record: the record, with the true motion if it is known.
    fixes: those of this replicate, shape (fixes, 2) in m; NaN where no fix came.
    settled: the first step after the settling time.
    """

    def __init__(self, record: ReplayRecord, fixes: Array, sensors: Sensors, settled: int) -> None:
        self.record, self.edges = record, cut_into_parts(settled, record.steps)
        self._fixes, self._sensors = fixes, sensors
        self._judging = find_judging_steps(len(fixes), sensors)
        self._sums: list[dict[str, tuple[float, int]]] = []
        #: of each piece, over their standard deviations
        self._innovations: list[Array] = []

    def add(self, estimated: Trajectory) -> None:
        """Add the estimates of the next piece: the steps between two neighbours of `self.edges`."""
        begin, end = self.edges[len(self._sums) : len(self._sums) + 2]
        sums = _sum_errors(self.record, estimated, begin)
        inside = slice(*np.searchsorted(self._judging, [begin, end]))
        position = foresee_fixes(estimated.state[self._judging[inside] - begin], self._sensors)
        sums["fix_residual"] = _sum_squares(self._fixes[inside] - position)
        innovation, covariance = estimated.innovation, estimated.innovation_covariance
        scaled = np.empty((0, 2))
        if innovation is not None and covariance is not None:
            at = np.all(np.isfinite(innovation), axis=1)
            scaled = innovation[at] / np.sqrt(np.einsum("kii->ki", covariance[at]))
            sums["nis"], sums["innovation"] = _sum_squares(scaled), _sum_squares(innovation[at])
        self._sums.append(sums)
        self._innovations.append(scaled)

    def measures(self) -> Iterator[Measured]:
        """Yield all as (measure, window, value, number of samples), after the last piece."""
        for window, begin in {"full": 0, "settled": 1}.items():
            yield from _average(self._sums[begin:], window)
            innovation = np.concatenate(self._innovations[begin:])
            if len(innovation) > 2 * LAGS:
                lag_1, p = check_whiteness(innovation)
                yield ("innovation_lag_1", window, lag_1, len(innovation))
                yield ("innovation_white_p", window, p, len(innovation))
        for number, part in enumerate(self._sums[1:]):
            shown = {name: part[name] for name in SHOWN if name in part}
            yield from _average([shown], f"part_{number:02d}")


def _average(pieces: Sequence[Mapping[str, tuple[float, int]]], window: str) -> Iterator[Measured]:
    for name in dict.fromkeys(name for piece in pieces for name in piece):
        sums, counts = zip(*(piece[name] for piece in pieces if name in piece), strict=True)
        if count := sum(counts):
            yield (name, window, sum(sums) / count, count)


def _sum_errors(
    record: ReplayRecord, estimated: Trajectory, begin: int
) -> dict[str, tuple[float, int]]:
    """Sum squared errors and NEES over a piece; count errors within ±1.96 standard deviations."""
    if record.position is None:
        return {}
    part = slice(begin, begin + len(estimated.state))
    error = estimated.state - np.hstack([record.position[part], record.given("velocity")[part]])
    squared, limit = error**2, (QUANTILE * estimated.deviation) ** 2
    x, y, vx, vy = squared.T
    series = {"x": x, "y": y, "vx": vx, "vy": vy, "position": x + y, "velocity": vx + vy}
    judged = np.isfinite(squared) & np.isfinite(limit)
    inside = (squared <= limit) & judged
    nees = [_weigh(error[:, axis::2], estimated.axis_covariance(axis)) for axis in range(2)]
    return {
        **{name: _sum_finite(values) for name, values in series.items()},
        "coverage_position": (float(inside[:, :2].sum()), int(judged[:, :2].sum())),
        "coverage_velocity": (float(inside[:, 2:].sum()), int(judged[:, 2:].sum())),
        "nees": _sum_finite(nees[0] + nees[1]),
    }


def _sum_finite(values: Array) -> tuple[float, int]:
    finite = np.isfinite(values)
    count = int(np.count_nonzero(finite))
    return float(np.sum(values if count == len(values) else values[finite])), count


def _sum_squares(values: Array) -> tuple[float, int]:
    return _sum_finite(np.sum(values**2, axis=1))


def _weigh(error: Array, covariance: Array) -> Array:
    p, v = error.T
    pp, pv, vv = covariance[:, 0, 0], covariance[:, 0, 1], covariance[:, 1, 1]
    weighted = vv * p**2 - 2.0 * pv * p * v + pp * v**2
    return np.asarray(weighted / (pp * vv - pv**2))


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
