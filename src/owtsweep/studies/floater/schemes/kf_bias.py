"""KF_BIAS: KF_CONSISTENT with the bias of each acceleration as a state."""

from __future__ import annotations

from owtsweep.studies.floater.schemes.linear import LinearScheme

SCHEME = LinearScheme("KF_BIAS", bias=True, delay=False)
