"""Decides which of two schemes is handed out, with hysteresis and bumpless transfer."""

from __future__ import annotations

from math import isnan

from owtsweep.studies.hub.switching.boundary import Boundary
from owtsweep.studies.hub.switching.sea import SeaWatch

#: An estimated amplitude counts as at least this much, m.
LEAST = 1e-9


class Supervisor:
    """The weight of the scheme above the boundary in what is handed out: 0 to 1.

    The scheme above the boundary is chosen when the estimated amplitude is larger than the
    boundary's at the estimated period, times the hysteresis; the scheme below the boundary when the
    amplitude is smaller than the boundary's divided by the hysteresis. In between the choice stays.
    After a new choice the weight moves to 0 or 1 at a constant rate, so that nothing jumps.

    Until the watch has seen a motion for its `memory`, the scheme above is chosen: it is the one
    whose error grows less with the motion.

    Parameters
    ----------
    watch
        The estimated amplitude and period.
    boundary
        The amplitudes above which the second scheme is better.
    hysteresis
        Ratio of at least 1.
    step, memory, blend
        Time between two estimates, time before the first choice, and time in which the weight moves
        from 0 to 1, s. With blend 0 the weight jumps.
    every
        Number of steps from one choice to the next.
    """

    def __init__(
        self,
        watch: SeaWatch,
        boundary: Boundary,
        *,
        hysteresis: float,
        step: float,
        memory: float,
        blend: float,
        every: int,
    ) -> None:
        self.watch, self.boundary = watch, boundary
        self._hysteresis = hysteresis
        self._every = every
        self._until_choice = max(round(memory / step), 1)
        self._rate = 1.0 if blend <= step else step / blend
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
