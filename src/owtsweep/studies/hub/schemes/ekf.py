"""EKF: the filter on model (6) with the GNSS innovation set to zero between fixes (section 5.3).

Model (6) is linear, so this "extended" filter is a Kalman filter. It uses the IMU without delay.
The paper does not say how the covariance is updated between fixes; `ekf.update_rule` decides.
`every_step` updates it as if there were a fix at every IMU step, which agrees best with the
published numbers. The rules of the MKF are available too; with `proper` the scheme is the MKF.
"""

from __future__ import annotations

from typing import Any

from owtsweep.studies.hub.chain import LONGEST_TRANSIENT, Chain, chain, shared
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.models import axis_filter
from owtsweep.studies.hub.online.estimator import OnlineEstimator, online_chain
from owtsweep.studies.hub.schemes.mkf import FilterEstimator


class EKF:
    """The extended Kalman filter of section 5.3, tuned by `ekf`."""

    name = "EKF"
    linear = True
    sections = ("ekf",)

    def start(self, sensors: Sensors, tuning: Any) -> FilterEstimator:
        """Start a fresh estimator."""
        return FilterEstimator(tuning.ekf, sensors)

    def stream(self, sensors: Sensors, tuning: Any) -> OnlineEstimator:
        """Start a fresh compiled estimator."""
        return online_chain(tuning.ekf, sensors)

    @shared
    def kernel(self, sensors: Sensors, tuning: Any, steps: int = LONGEST_TRANSIENT) -> Chain:
        """The scheme's form for the batch engine, for records of `steps` IMU steps."""
        return chain(
            axis_filter(tuning.ekf, sensors), sensors, rule=tuning.ekf.update_rule, steps=steps
        )


SCHEME = EKF()
