"""Estimates the amplitude and the period of a motion from estimates of position and velocity."""

from __future__ import annotations

from math import exp, pi, sqrt

from owtsweep.arrays import Array


class SeaWatch:
    """The amplitude and the period of a motion, from exponentially forgotten variances.

    The variances of position and velocity are taken about their forgotten means, so an offset of
    the hub does not count. The variances of the estimates' own errors, as their scheme states them,
    are subtracted.

    Parameters
    ----------
    step
        Time between two estimates, s.
    memory
        Time after which an estimate has the weight 1/e, s.
    crest
        Amplitude of the motion divided by the root mean square of the displacement.
    """

    def __init__(self, step: float, memory: float, crest: float) -> None:
        self._keep, self._crest = exp(-step / memory), crest
        self._weight = 0.0
        self._noise = (0.0, 0.0)
        # of x, y, v_x, v_y: forgotten sums, and forgotten sums of squares
        self._sums, self._squares = [0.0] * 4, [0.0] * 4

    def take(self, x: float, y: float, vx: float, vy: float, noise: tuple[float, float]) -> None:
        """Take the estimates of a step: position (m) and velocity (m/s), north and east.

        `noise` holds the variances of their errors, of both axes together: m^2 and (m/s)^2.
        """
        keep, sums, squares = self._keep, self._sums, self._squares
        self._weight = keep * self._weight + 1.0
        self._noise = noise
        for i, value in enumerate((x, y, vx, vy)):
            sums[i] = keep * sums[i] + value
            squares[i] = keep * squares[i] + value * value

    def describe(self) -> tuple[float, float]:
        """Return the amplitude (m) and the period (s) of the motion.

        The period is 2 pi rms(position) / rms(velocity). It is NaN, and the amplitude 0, where no
        motion stands out of the errors.
        """
        if self._weight == 0.0:
            return 0.0, float("nan")
        means = [total / self._weight for total in self._sums]
        variances = [
            square / self._weight - mean * mean
            for square, mean in zip(self._squares, means, strict=True)
        ]
        position = variances[0] + variances[1] - self._noise[0]
        velocity = variances[2] + variances[3] - self._noise[1]
        if not (position > 0.0 and velocity > 0.0):
            return 0.0, float("nan")
        return self._crest * sqrt(position), 2.0 * pi * sqrt(position / velocity)


def error_variances(covariance: Array | None) -> tuple[float, float]:
    """Return the variances of position (m^2) and velocity ((m/s)^2), each of both axes together.

    `covariance` (4, 4) is that of x, y, v_x, v_y. Without a covariance the variances are zero.
    """
    if covariance is None:
        return 0.0, 0.0
    return (
        float(covariance[0, 0] + covariance[1, 1]),
        float(covariance[2, 2] + covariance[3, 3]),
    )
