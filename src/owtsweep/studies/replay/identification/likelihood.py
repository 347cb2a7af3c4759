"""The likelihood of noise and delay, given positions and the acceleration that an IMU measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dpbtrf, dtbtrs

from owtsweep.arrays import Array
from owtsweep.studies.replay.identification.differences import Differences, take_differences

#: The parameters of a likelihood, in this order.
PARAMETERS = ("force_sigma", "position_sigma", "bias_walk", "delay")
#: Largest difference between the delay that is tried and the delay that was stated, s.
REACH = 2.0
#: Relative standard error of `Problem.floor`. It is not from counting samples, which would give
#: less: a spectrum is flat to some per cent at best.
FLOOR_ERROR = 0.02


@dataclass(frozen=True)
class DoubleIntegral:
    """The double integral of an acceleration, zero with zero slope at time 0.

    Attributes
    ----------
    step
        Time between samples, s.
    position, velocity
        The double and the single integral at the samples, shape (n, 2), in m and m/s.
    """

    step: float
    position: Array
    velocity: Array

    @property
    def duration(self) -> float:
        """The time of the last sample, s."""
        return self.step * (len(self.position) - 1)

    def at(self, time: Array) -> Array:
        """Return the double integral at times in s, shape (m, 2) in m, by cubic interpolation.

        Times before the first or after the last sample are extrapolated.
        """
        index = np.clip((time / self.step).astype(int), 0, len(self.position) - 2)
        part = (time / self.step - index)[:, None]
        p0, p1 = self.position[index], self.position[index + 1]
        v0, v1 = self.step * self.velocity[index], self.step * self.velocity[index + 1]
        rise = p1 - p0
        second, third = 3.0 * rise - 2.0 * v0 - v1, v0 + v1 - 2.0 * rise
        return np.asarray(p0 + part * (v0 + part * (second + part * third)))


def integrate_twice(acceleration: Array, step: float) -> DoubleIntegral:
    """Integrate an acceleration twice, shape (n, 2) in m/s^2, sampled every `step` seconds.

    The mean is subtracted first, so that the integral stays small. Whoever uses the integral must
    therefore not depend on a constant acceleration.
    """
    velocity = _integrate(acceleration - acceleration.mean(axis=0), step)
    return DoubleIntegral(step, _integrate(velocity, step), velocity)


def _integrate(values: Array, step: float) -> Array:
    """Return the integral from the first sample to each sample; its error is of fourth order."""
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

    Attributes
    ----------
    integral
        The double integral of the acceleration, in NED.
    time
        Times of the positions on the clock of the IMU, shape (n,), s.
    differences
        The third differences of series at these times.
    measured
        The differences of the measured positions, shape (m, 2).
    floor
        IMU sigma that the IMU's own spectrum shows (m/s^2, `measure_floor`); NaN: not used.
    """

    integral: DoubleIntegral
    time: Array
    differences: Differences
    measured: Array
    floor: float = np.nan

    def residual(self, delay: float, gain: Array | None = None) -> Array:
        """Return the differences of positions minus double integral, shape (m, 2).

        Parameters
        ----------
        delay
            How long ago the measured positions were true, s.
        gain
            Matrix (2, 2) by which the acceleration is multiplied first; None for the unit matrix.
        """
        moved = self.differences.apply(self.integral.at(self.time - delay))
        return self.measured - (moved if gain is None else moved @ gain.T)

    def whiten(self, noise: Array, residual: Array) -> tuple[Array, float]:
        """Return residuals divided by their stated deviation, and their log likelihood.

        Parameters
        ----------
        noise
            Standard deviation of an IMU sample (m/s^2) and of a position (m), and the bias walk
            (m/s^2/sqrt(s)), shape (3,).
        residual
            What `residual` returns.

        Returns
        -------
        tuple
            The innovations, shape (m, 2), independent with variance 1 if the noise is right; and
            the logarithm of their likelihood, minus infinity where it cannot be computed.
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

    Parameters
    ----------
    integral
        The double integral of the measured acceleration, in NED; time 0 is its first sample.
    time, positions
        When positions came (s, shape (n,)) and what they said (m, shape (n, 2)); NaN: none came.
    delay
        The stated delay, s. Positions for whose time, at any delay within `REACH`, there is no
        acceleration are left out.
    """
    known = np.all(np.isfinite(positions), axis=1)
    known &= (time - delay - REACH >= 0.0) & (time - delay + REACH <= integral.duration)
    if np.count_nonzero(known) < 8:
        return None
    differences = take_differences(time[known])
    return Problem(integral, time[known], differences, differences.apply(positions[known]))
