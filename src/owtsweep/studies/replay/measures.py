"""Measure estimates of schemes and baselines: errors, coverage, distances to later fixes.

Without a reference position, an estimate is compared with the fix that arrives one GNSS delay later
and reports the same moment; the estimate has not used it. A fix without delay is compared with the
estimate of the IMU step before it, carried on by its own velocity. The mean squared distance is the
MSE plus the variance of a fix, which is equal for all schemes.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.studies.hub.public import DELTA, HOLD, NONE, Baseline, Sensors
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
#: The measures of baselines; HOLD has those of each axis too.
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
        self.record, self.settled = record, settled
        self.edges = cut_into_parts(settled, record.steps)
        self._sums: list[dict[str, tuple[float, int]]] = []
        nothing = np.empty((0, 2))
        self._innovations: list[tuple[NDArray[np.int64], Array, Array]] = [
            (np.empty(0, dtype=np.int64), nothing, nothing)
        ]
        self._sensors = sensors
        judging = find_judging_steps(len(fixes), sensors)
        judged = (judging >= 0) & (judging < record.steps)
        self._judging, self._fixes = judging[judged], fixes[judged]
        self._residual = np.empty(len(self._judging))

    def add(self, estimated: Trajectory) -> None:
        """Add the estimates of the next piece: the steps between two neighbours of `self.edges`."""
        begin, end = self.edges[len(self._sums) : len(self._sums) + 2]
        self._sums.append(_sum_errors(self.record, estimated, begin))
        inside = slice(*np.searchsorted(self._judging, [begin, end]))
        position = foresee_fixes(estimated.state[self._judging[inside] - begin], self._sensors)
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
            late = self._judging >= begin
            yield from _average("fix_residual", window, self._residual[late])
            yield from _judge_innovations(innovation[at >= begin], variance[at >= begin], window)
        for number, (begin, end) in enumerate(itertools.pairwise(self.edges[1:])):
            inside = (self._judging >= begin) & (self._judging < end)
            yield from _average("fix_residual", f"part_{number:02d}", self._residual[inside])


def _average_errors(pieces: Sequence[dict[str, tuple[float, int]]]) -> Iterator[Measured]:
    windows = {"full": pieces, "settled": pieces[1:]}
    windows |= {f"part_{number:02d}": [piece] for number, piece in enumerate(pieces[1:])}
    for window, chosen in windows.items():
        for name in pieces[0]:
            count = sum(piece[name][1] for piece in chosen)
            if count and (window in WINDOWS or name in ("position", "velocity")):
                yield (name, window, sum(piece[name][0] for piece in chosen) / count, count)


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


def _weigh(error: Array, covariance: Array) -> Array:
    p, v = error.T
    pp, pv, vv = covariance[:, 0, 0], covariance[:, 0, 1], covariance[:, 1, 1]
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


def _draw_lines(line: Baseline, fixes: Array, sensors: Sensors) -> tuple[Array, Array]:
    """Return positions (m) when fixes are due, and slopes (m/s), both (fixes, 2); zero at first."""
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
    line: Baseline, fixes: Array, sensors: Sensors, edges: Sequence[int]
) -> Iterator[Trajectory]:
    """Yield a baseline's estimates from each of the steps `edges` to the next."""
    start, slope = _draw_lines(line, fixes, sensors)
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
    for row, line in zip(BASELINE_ROWS, (NONE, HOLD, DELTA), strict=True):
        tally = Tally(record, fixes, sensors, settled)
        for piece in follow(line, fixes, sensors, tally.edges):
            tally.add(piece)
        shown = (*SHOWN, "x", "y") if row == "last_fix" else SHOWN
        for measured in tally.measures():
            if measured[0] in shown:
                yield row, measured
