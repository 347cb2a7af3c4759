"""Watches the sea, and decides which of two schemes is handed out, without bumps."""

from __future__ import annotations

from math import exp, isnan, pi, sqrt

from owtsweep.arrays import Array
from owtsweep.studies.hub.scheme_sections import Switch
from owtsweep.studies.hub.switching.boundary import Boundary


class SeaWatch:
    """The amplitude and the period of a motion, from exponentially forgotten variances.

    The variances of position and velocity are taken about their forgotten means, so an offset of
    the hub does not count. The variances of the estimates' own errors, as their scheme states them,
    are subtracted.

    step: time between two estimates, s.
    memory: time after which an estimate has the weight 1/e, s.
    crest: amplitude of the motion divided by the root mean square of the displacement.
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
    x, y, vx, vy = covariance.diagonal().tolist()
    return x + y, vx + vy


#: An estimated amplitude counts as at least this much, m.
LEAST = 1e-9


class Supervisor:
    """The weight of the scheme above the boundary in what is handed out: 0 to 1.

    The scheme above the boundary is chosen when the estimated amplitude is larger than the
    boundary's at the estimated period, times the hysteresis; the scheme below when it is smaller
    than the boundary's divided by the hysteresis. In between the choice stays. After a new choice
    the weight moves to 0 or 1 at a constant rate, so that nothing jumps.

    Until the watch has seen a motion for its `memory`, the scheme above is chosen: it is the one
    whose error grows less with the motion.

    settings: of which it takes hysteresis, memory and blend. With blend 0 the weight jumps.
    step: time between two estimates, s.
    every: number of steps from one choice to the next.
    """

    def __init__(
        self, watch: SeaWatch, boundary: Boundary, settings: Switch, step: float, every: int
    ) -> None:
        self.watch, self.boundary = watch, boundary
        self._hysteresis, self._every = settings.hysteresis, every
        self._until_choice = max(round(settings.memory / step), 1)
        self._rate = 1.0 if settings.blend <= step else step / settings.blend
        self._above, self._weight = True, 1.0
        #: How often the choice has changed.
        self.switches = 0

    def step(self, x: float, y: float, vx: float, vy: float, noise: tuple[float, float]) -> float:
        """Take the watched estimates of a step as `SeaWatch.take` does; return the weight.

        Estimates that are NaN, as before the first fix, are not watched.
        """
        if isnan(x):
            return self._weight
        self.watch.take(x, y, vx, vy, noise)
        self._until_choice -= 1
        if self._until_choice == 0:
            self._choose()
            self._until_choice = self._every
        goal = 1.0 if self._above else 0.0
        if self._weight < goal:
            self._weight = min(self._weight + self._rate, goal)
        elif self._weight > goal:
            self._weight = max(self._weight - self._rate, goal)
        return self._weight

    def _choose(self) -> None:
        amplitude, period = self.watch.describe()
        edge = self.boundary.amplitude(period)
        if self._above:
            changes = max(amplitude, LEAST) < edge / self._hysteresis
        else:
            changes = amplitude > edge * self._hysteresis
        if changes:
            self._above = not self._above
            self.switches += 1
