"""EKF: the Kalman filter on model (6), with the GNSS innovation set to zero between fixes.

Sources: section 5.3 and Eq. (6) of Ren et al. (2019). Model (6) is linear, so this "extended"
filter is a Kalman filter. The IMU is used without delay. The paper does not say how the covariance
is updated between position fixes; the key `ekf.update_rule` decides. With `every_step` the
covariance is updated as if there were a fix at every IMU step, which agrees best with the published
numbers. The rules of the MKF are available too; with `proper` the scheme is the MKF.
"""

from __future__ import annotations

from owtsweep.studies.hub.schemes.mkf import FilterScheme

SCHEME = FilterScheme("EKF", "ekf")
