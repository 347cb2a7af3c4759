"""EKF: a Kalman filter whose innovation of the position is zero between the GNSS position fixes.

Sources: section 5.3 and Eq. (6) of Ren et al. (2019). The model, Eq. (6), is linear, so this
"extended" filter is a Kalman filter. The IMU is used without delay. The paper does not say how the
covariance is updated between position fixes; the key `ekf.update_rule` decides. With the rule
`every_step` the covariance is updated as if there were a fix at every IMU step. This rule agrees
best with the published numbers. The rules of the scheme MKF are available too; with the rule
`proper`, EKF is the same filter as MKF.
"""

from __future__ import annotations

from owtsweep.studies.hub.schemes.mkf import FilterScheme

SCHEME = FilterScheme("EKF", "ekf")
