"""MKF: the multirate Kalman filter alone (Algorithm 6 and section 5.3 of Ren et al. 2019).

The filter combines delayed position fixes with the undelayed IMU. There is no register that delays
the IMU, no smoother and no predictor. The estimate is compared with the present motion. So the
delay of the GNSS makes the estimate lag.
"""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Estimate
from owtsweep.studies.hub.chain import LONGEST_TRANSIENT, Chain, chain, shared
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.fix_rules import make_fix_rule
from owtsweep.studies.hub.models import axis_filter
from owtsweep.studies.hub.online.chain import online_chain
from owtsweep.studies.hub.online.coordinates import ZERO
from owtsweep.studies.hub.online.estimator import OnlineEstimator
from owtsweep.studies.hub.scheme_sections import FilterTuning
from owtsweep.studies.hub.schemes.multirate import MultirateKalmanFilter
from owtsweep.studies.hub.schemes.stepwise import Stepwise


class FilterEstimator:
    """A multirate Kalman filter alone, as an estimator that runs step by step."""

    def __init__(self, tuning: FilterTuning, sensors: Sensors) -> None:
        self.filter = MultirateKalmanFilter(
            axis_filter(tuning, sensors),
            sensors.rotation,
            tuning.update_rule,
            make_fix_rule(tuning),
        )

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        """Take an IMU sample, and a position fix or None; return the filtered state.

        `specific_force` is in the IMU's frame, m/s^2, shape (2,); `position` is in NED, m, (2,).
        """
        step = self.filter.step(specific_force, position)
        return Estimate(step.x[:2], step.x[2:4], step.P[:4, :4], step.innovation)


class FilterScheme:
    """A scheme that consists of a multirate Kalman filter alone, such as EKF and MKF.

    `section` is the section of the configuration that tunes the filter.
    """

    linear = True

    def __init__(self, name: str, section: str) -> None:
        self.name = name
        self.sections = (section,)

    def start(self, sensors: Sensors, tuning: Any) -> FilterEstimator:
        """Return a new estimator that runs step by step."""
        return FilterEstimator(self._choose(tuning), sensors)

    def stream(
        self, sensors: Sensors, tuning: Any, origin: ArrayLike | None = ZERO
    ) -> OnlineEstimator:
        """Return a new compiled estimator that runs step by step; `origin` as in `online_chain`."""
        return online_chain(self._choose(tuning), sensors, origin=origin)

    def under(self, tuning: Any) -> FilterScheme | Stepwise:
        """Return the scheme for a tuning: `Stepwise` if fixes lose weight, else `self`."""
        return (
            self
            if self._choose(tuning).fix_rule == "plain"
            else Stepwise(self, "its fix_rule leaves")
        )

    @shared
    def kernel(self, sensors: Sensors, tuning: Any, steps: int = LONGEST_TRANSIENT) -> Chain:
        """Return the scheme in its form for the batch engine, for records of `steps` IMU steps."""
        chosen = self._choose(tuning)
        return chain(axis_filter(chosen, sensors), sensors, rule=chosen.update_rule, steps=steps)

    def _choose(self, tuning: Any) -> FilterTuning:
        chosen: FilterTuning = getattr(tuning, self.sections[0])
        return chosen


SCHEME = FilterScheme("MKF", "mkf")
