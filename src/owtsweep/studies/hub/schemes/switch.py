"""SWITCH: two schemes side by side, of which a supervisor hands out one.

The conclusion of Ren et al. (2019) proposes to switch between HME1 and HME2 by the amplitude and
the period of the motion.
"""

from __future__ import annotations

from collections.abc import Callable

from numpy.typing import ArrayLike

from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import ZERO, Estimator, Known, Scheme
from owtsweep.studies.hub.listed import resolve
from owtsweep.studies.hub.switching.boundary import check_switch, compute_boundary, read_boundary
from owtsweep.studies.hub.switching.estimator import SwitchingEstimator
from owtsweep.studies.hub.switching.supervisor import SeaWatch, Supervisor


class SupervisorySwitching(Scheme):
    """The scheme SWITCH. Its tuning is the section `switch` and the sections of its two schemes."""

    name = "SWITCH"
    on_board = True
    sections: tuple[str, ...] = ("switch", "ekf", "mkf", "hme1", "hme2", "hme")

    def under(self, config: HubConfig) -> SupervisorySwitching:
        """Return the scheme with the sections of those two schemes that the tuning names."""
        below, above = _choose_schemes(config)
        chosen = SupervisorySwitching()
        chosen.sections = ("switch", *dict.fromkeys((*below.sections, *above.sections)))
        return chosen

    def start(self, known: Known) -> SwitchingEstimator:
        return _start(known, lambda scheme: scheme.start(known))

    def stream(self, known: Known, origin: ArrayLike | None = ZERO) -> SwitchingEstimator:
        """Return a new estimator of two schemes that are compiled where they can be."""
        return _start(known, lambda scheme: scheme.stream(known, origin))

    def check(self, config: HubConfig) -> None:
        check_switch(self.name, config.switch)


def _choose_schemes(config: HubConfig) -> tuple[Scheme, Scheme]:
    below, above = resolve(config.switch.below), resolve(config.switch.above)
    return below.under(config), above.under(config)


def _start(known: Known, started: Callable[[Scheme], Estimator]) -> SwitchingEstimator:
    """Return a new estimator; `started` makes that of each of the two schemes."""
    sensors, settings = known.sensors, known.tuning.switch
    below, above = _choose_schemes(known.tuning)
    if settings.boundary is None:
        boundary = compute_boundary(known.tuning, settings.below, settings.above, settings.crest)
    else:
        boundary = read_boundary(settings.boundary)
    watch = SeaWatch(sensors.step, settings.memory, settings.crest)
    supervisor = Supervisor(watch, boundary, settings, sensors.step, sensors.fix_interval)
    return SwitchingEstimator(started(below), started(above), supervisor)


SCHEME = SupervisorySwitching()
