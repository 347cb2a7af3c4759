"""KF_CONSISTENT: the time-varying filter whose process noise is that of noisy accelerations.

What it has otherwise than KF: noise enters the velocity only, by the measured acceleration; the
acceleration goes linearly from sample to sample, where KF holds it and so takes velocities half a
step late; and the estimate of a sample knows its report.
"""

from __future__ import annotations

from owtsweep.studies.floater.schemes.linear import LinearScheme

SCHEME = LinearScheme("KF_CONSISTENT", bias=False, delay=False)
