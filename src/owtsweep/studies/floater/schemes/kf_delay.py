"""KF_DELAY: KF_CONSISTENT at the time that a report shows, then predicted to now."""

from __future__ import annotations

from owtsweep.studies.floater.schemes.linear import LinearScheme

SCHEME = LinearScheme("KF_DELAY", bias=False, delay=True)
