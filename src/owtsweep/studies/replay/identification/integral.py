"""Integrate a measured acceleration twice, and evaluate the integral at any time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array


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
