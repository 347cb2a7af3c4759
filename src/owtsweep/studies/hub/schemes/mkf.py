"""MKF: the multirate Kalman filter alone (Algorithm 6 and section 5.3 of Ren et al. 2019).

The filter combines delayed position fixes with the undelayed IMU. There is no register that delays
the IMU, no smoother and no predictor. The estimate is compared with the present motion. So the
delay of the GNSS makes the estimate lag.

EKF is the same filter, but with an innovation of the position that is zero between the fixes
(section 5.3 and Eq. 6). The model, Eq. (6), is linear, so this "extended" filter is a Kalman
filter. The paper does not say how the covariance is updated between fixes; the key
`ekf.update_rule` decides. With the rule `every_step` the covariance is updated as if there were a
fix at every IMU step, which agrees best with the published numbers. With the rule `proper`, EKF is
MKF.
"""

from __future__ import annotations

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Estimate
from owtsweep.studies.hub.chain import Parts
from owtsweep.studies.hub.contract import Known
from owtsweep.studies.hub.models import axis_filter, make_fix_rule
from owtsweep.studies.hub.schemes.chained import FilterScheme
from owtsweep.studies.hub.schemes.multirate import MultirateKalmanFilter
from owtsweep.studies.hub.sensors import Sensors


class FilterEstimator:
    """A multirate Kalman filter alone, as an estimator that runs step by step."""

    def __init__(self, parts: Parts, sensors: Sensors) -> None:
        self.filter = MultirateKalmanFilter(parts, sensors.rotation)

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        """Take an IMU sample, and a position fix or None; return the filtered state."""
        step = self.filter.step(specific_force, position)
        return Estimate(step.x[:2], step.x[2:4], step.P[:4, :4], step.innovation)


class FilterAlone(FilterScheme):
    """A scheme of a multirate Kalman filter alone, which the key `section` tunes."""

    def __init__(self, name: str, section: str) -> None:
        self.name = name
        self.sections = (section,)

    def start(self, known: Known) -> FilterEstimator:
        return FilterEstimator(self.find_parts(known), known.sensors)

    def find_parts(self, known: Known) -> Parts:
        chosen = self.choose_filter(known.tuning)
        axis = axis_filter(chosen, known.sensors)
        return Parts(axis, chosen.update_rule, make_fix_rule(chosen))


SCHEME = FilterAlone("MKF", "mkf")
EKF = FilterAlone("EKF", "ekf")
