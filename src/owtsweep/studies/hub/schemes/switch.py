"""SWITCH: two schemes side by side, of which a supervisor hands out one.

The conclusion of Ren et al. (2019) proposes to switch between HME1 and HME2 by the amplitude and
the period of the motion.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numpy.typing import ArrayLike

from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.online.coordinates import ZERO
from owtsweep.studies.hub.switching.boundary import Boundary, compute_boundary, read_boundary
from owtsweep.studies.hub.switching.estimator import SwitchingEstimator
from owtsweep.studies.hub.switching.sea import SeaWatch
from owtsweep.studies.hub.switching.supervisor import Supervisor


class SupervisorySwitching:
    """The scheme SWITCH. Its tuning is the section `switch` and the sections of its two schemes."""

    name = "SWITCH"
    linear = False
    sections: tuple[str, ...] = ("switch", "ekf", "mkf", "hme1", "hme2", "hme")

    def under(self, tuning: Any) -> SupervisorySwitching:
        """Return the scheme with the sections of those two schemes that the tuning names."""
        below, above = _choose_schemes(tuning)
        chosen = SupervisorySwitching()
        named = (*below.sections, *above.sections)
        chosen.sections = ("switch", *dict.fromkeys(named))
        return chosen

    def start(self, sensors: Sensors, tuning: Any) -> SwitchingEstimator:
        """Return a new estimator that runs step by step."""
        return _start(sensors, tuning, lambda scheme: scheme.start(sensors, tuning))

    def stream(
        self, sensors: Sensors, tuning: Any, origin: ArrayLike | None = ZERO
    ) -> SwitchingEstimator:
        """Return a new estimator whose two schemes are compiled where they can be.

        `origin` is that of both schemes, as in `online_chain`.
        """

        def started(scheme: Any) -> Any:
            if hasattr(scheme, "stream"):
                return scheme.stream(sensors, tuning, origin)
            return scheme.start(sensors, tuning)

        return _start(sensors, tuning, started)


def _choose_schemes(tuning: Any) -> tuple[Any, Any]:
    """Return the schemes below and above the boundary."""
    from owtsweep.studies.hub.resolving import resolve, under

    settings = tuning.switch
    return under(resolve(settings.below), tuning), under(resolve(settings.above), tuning)


def _start(sensors: Sensors, tuning: Any, started: Callable[[Any], Any]) -> SwitchingEstimator:
    """Return a new estimator; `started` makes that of each of the two schemes."""
    settings = tuning.switch
    below, above = _choose_schemes(tuning)
    supervisor = Supervisor(
        SeaWatch(sensors.step, settings.memory, settings.crest),
        _make_boundary(tuning),
        hysteresis=settings.hysteresis,
        step=sensors.step,
        memory=settings.memory,
        blend=settings.blend,
        every=sensors.fix_interval,
    )
    return SwitchingEstimator(started(below), started(above), supervisor)


def _make_boundary(tuning: Any) -> Boundary:
    """Return the boundary that the tuning states, or else the one of the two schemes' errors."""
    settings = tuning.switch
    if settings.boundary is not None:
        return read_boundary(settings.boundary)
    return compute_boundary(tuning, settings.below, settings.above, settings.crest)


SCHEME = SupervisorySwitching()
