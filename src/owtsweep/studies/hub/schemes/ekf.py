"""EKF: the filter on model (6) with the GNSS innovation set to zero between fixes (section 5.3).

Model (6) is linear, so this "extended" filter is a Kalman filter. It uses the IMU without delay.
The paper does not say how the covariance is updated between fixes; `ekf.update_rule` decides.
`every_step` updates it as if there were a fix at every IMU step, which agrees best with the
published numbers. The rules of the MKF are available too; with `proper` the scheme is the MKF.
"""

from __future__ import annotations

from owtsweep.studies.hub.schemes.mkf import FilterScheme

SCHEME = FilterScheme("EKF", "ekf")
