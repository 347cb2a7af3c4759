"""The likelihood of noise and delay, given positions and the acceleration that an IMU measured.

The difference between a measured position and the double integral of the measured acceleration
holds no motion. It is an unknown parabola (position and velocity at the start, constant bias), the
double integral of the IMU's white noise, the triple integral of the bias walk's noise, and the
noise of the measured position. Third divided differences remove every parabola. What is left has a
covariance with three bands beside its diagonal, so the exact likelihood takes microseconds.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dpbtrf, dtbtrs

from owtsweep.arrays import Array

#: Points that a third difference needs.
POINTS = 4
#: Positions in a piece; longer series are cut, because the covariance becomes nearly singular.
LONGEST = 600
#: The parameters of a likelihood, in this order.
PARAMETERS = ("force_sigma", "position_sigma", "bias_walk", "delay")
#: Largest difference between the delay that is tried and the delay that was stated, s.
REACH = 2.0
#: Relative standard error of `Problem.floor`. It is not from counting samples, which would give
#: less: a spectrum is flat to some per cent at best.
FLOOR_ERROR = 0.02


class Differences(NamedTuple):
    """Third differences of a series of positions at given times.

    first, weights: index of the first of the four positions of each difference, (n,), and the four
        weights, (n, 4).
    of_position, of_white, of_walk: covariance of the differences for positions with white noise of
        1 m, for white acceleration noise of density 1 (m/s^2)^2/Hz, and for an acceleration bias
        that walks with density 1 (m/s^2)^2/s; (4, n), row k being that of difference j with j + k.
    """

    first: NDArray[np.int64]
    weights: Array
    of_position: Array
    of_white: Array
    of_walk: Array

    def apply(self, positions: Array) -> Array:
        """Return the third differences of a series, shape (n, 2), of positions (m, 2)."""
        return np.asarray(
            sum(self.weights[:, [k]] * positions[self.first + k] for k in range(POINTS))
        )


def take_differences(time: Array) -> Differences:
    """Make the third differences of positions at increasing times in s, shape (m,), m >= 4."""
    at = np.lib.stride_tricks.sliding_window_view(time, POINTS)
    apart = at[:, :, None] - at[:, None, :]
    apart[:, range(POINTS), range(POINTS)] = 1.0
    # for equal intervals the weights are -1, 3, -3, 1
    weights = 6.0 * np.median(np.diff(time)) ** 3 / np.prod(apart, axis=2)
    # what the noise of the interval after point i adds to each difference
    carried = np.zeros((len(at), POINTS - 1, 3))
    for i in range(POINTS - 1):
        for k in range(i + 1, POINTS):
            late = at[:, k] - at[:, i + 1]
            row = np.stack([np.ones_like(late), late, 0.5 * late**2], axis=1)
            carried[:, i] += weights[:, [k]] * row
    white, walk = _noise_of_intervals(np.diff(time))
    bands = np.zeros((3, POINTS, len(at)))
    for lag in range(min(POINTS, len(at))):
        here, there = slice(0, len(at) - lag), slice(lag, len(at))
        for k in range(lag, POINTS):
            bands[0, lag, here] += weights[here, k] * weights[there, k - lag]
        for i in range(lag, POINTS - 1):
            left, right = carried[here, i], carried[there, i - lag]
            inside = slice(i, i + len(at) - lag)
            for part, noise in ((1, white), (2, walk)):
                bands[part, lag, here] += np.einsum("ja,jab,jb->j", left, noise[inside], right)
    # without three differences in a row, what comes before and what comes after is independent
    at_all = np.arange(len(at), dtype=np.int64)
    kept = at_all[at_all % LONGEST < LONGEST - (POINTS - 1)]
    cut = bands[:, :, kept]
    for lag in range(1, POINTS):
        far = np.ones(len(kept), dtype=bool)
        far[: len(kept) - lag] = kept[lag:] - kept[: len(kept) - lag] != lag
        cut[:, lag, far] = 0.0
    return Differences(kept, weights[kept], *cut)


def _noise_of_intervals(length: Array) -> tuple[Array, Array]:
    """Return the covariance of position, velocity and bias, (n, 3, 3), that each interval (s) adds.

    The first is that of white acceleration noise, the second that of a bias walk, of unit density.
    The p-fold and the q-fold integral of one white noise, after its first one, have the covariance
    length^(p + q + 1) / ((p + q + 1) p! q!).
    """
    white, walk = np.zeros((2, len(length), 3, 3))
    for noise, driven in ((white, 1), (walk, 2)):  # the noise drives velocity, or bias
        for row, column in itertools.product(range(driven + 1), repeat=2):
            p, q = driven - row, driven - column
            share = (p + q + 1) * math.factorial(p) * math.factorial(q)
            noise[:, row, column] = length ** (p + q + 1) / share
    return white, walk


@dataclass(frozen=True)
class DoubleIntegral:
    """The double integral of an acceleration, zero with zero slope at time 0.

    `position` and `velocity` are the double and the single integral every `step` s, (n, 2), m and
    m/s.
    """

    step: float
    position: Array
    velocity: Array

    @property
    def duration(self) -> float:
        """The time of the last sample, s."""
        return self.step * (len(self.position) - 1)

    def at(self, time: Array) -> Array:
        """Return the double integral, (m, 2) in m, at times in s, by cubic interpolation."""
        index = np.clip((time / self.step).astype(int), 0, len(self.position) - 2)
        part = (time / self.step - index)[:, None]
        p0, p1 = self.position[index], self.position[index + 1]
        v0, v1 = self.step * self.velocity[index], self.step * self.velocity[index + 1]
        rise = p1 - p0
        second, third = 3.0 * rise - 2.0 * v0 - v1, v0 + v1 - 2.0 * rise
        return np.asarray(p0 + part * (v0 + part * (second + part * third)))


def integrate_twice(acceleration: Array, step: float) -> DoubleIntegral:
    """Integrate an acceleration twice, shape (n, 2) in m/s^2, sampled every `step` seconds.

    The mean is subtracted first: whoever uses the integral must not depend on a constant
    acceleration.
    """
    velocity = _integrate(acceleration - acceleration.mean(axis=0), step)
    return DoubleIntegral(step, _integrate(velocity, step), velocity)


def _integrate(values: Array, step: float) -> Array:
    area = 0.5 * (values[:-1] + values[1:])
    # the cubic through four samples, instead of the line through two
    area[1:-1] -= (values[:-3] - values[1:-2] - values[2:-1] + values[3:]) / 24.0
    result = np.zeros_like(values)
    np.cumsum(area, axis=0, out=result[1:])
    result *= step
    return result


@dataclass(frozen=True)
class Problem:
    """Positions, and the acceleration that an IMU measured; both axes share all parameters.

    integral: the double integral of the acceleration, in NED.
    time: of the positions on the clock of the IMU, shape (n,), s.
    differences, measured: third differences at these times, and those of the positions, (m, 2).
    floor: IMU sigma that the IMU's own spectrum shows (m/s^2, `measure_floor`); NaN: not used.
    """

    integral: DoubleIntegral
    time: Array
    differences: Differences
    measured: Array
    floor: float = np.nan

    def residual(self, delay: float, gain: Array | None = None) -> Array:
        """Return the differences of positions minus double integral, shape (m, 2).

        Positions were true `delay` seconds ago; `gain`, (2, 2), multiplies the acceleration first.
        """
        moved = self.differences.apply(self.integral.at(self.time - delay))
        return self.measured - (moved if gain is None else moved @ gain.T)

    def whiten(self, noise: Array, residual: Array) -> tuple[Array, float]:
        """Return innovations, (m, 2), of variance 1 if the noise is right, and the log likelihood.

        noise: of an IMU sample (m/s^2), of a position (m), and the bias walk (m/s^2/sqrt(s)), shape
            (3,).
        residual: what `residual` returns.
        """
        parts, density = self.differences, self.integral.step * noise[0] ** 2
        covariance = (
            density * parts.of_white + noise[1] ** 2 * parts.of_position
            + noise[2] ** 2 * parts.of_walk
        )  # fmt: skip
        factor, failed = dpbtrf(covariance, lower=1)
        if failed:
            return residual, -np.inf
        innovation, _ = dtbtrs(factor, residual, uplo="L")
        axes = residual.shape[1]
        spread = np.sum(np.log(factor[0])) + 0.5 * len(residual) * np.log(2.0 * np.pi)
        value = -0.5 * np.sum(innovation**2) - axes * spread
        if np.isfinite(self.floor):
            value -= 0.5 * (np.log(noise[0] / self.floor) / FLOOR_ERROR) ** 2
        return innovation, float(value)


def pose(integral: DoubleIntegral, time: Array, positions: Array, delay: float) -> Problem | None:
    """Make the problem of positions at given times; None if fewer than 8 can be used.

    integral: of the measured acceleration, in NED; time 0 is its first sample.
    time, positions: when positions came (s, (n,)) and what they said (m, (n, 2)); NaN: none came.
    delay: the stated one, s. Positions without acceleration at a delay within `REACH` are left out.
    """
    known = np.all(np.isfinite(positions), axis=1)
    known &= (time - delay - REACH >= 0.0) & (time - delay + REACH <= integral.duration)
    if np.count_nonzero(known) < 8:
        return None
    differences = take_differences(time[known])
    return Problem(integral, time[known], differences, differences.apply(positions[known]))
