"""KF_REPAIRED: KF_CONSISTENT with the bias as a state, and with the delay compensated."""

from __future__ import annotations

from owtsweep.studies.floater.schemes.linear import LinearScheme

SCHEME = LinearScheme("KF_REPAIRED", bias=True, delay=True)
