"""MEKF_OFFSET: MEKF with the offset of the GNSS clock as a state."""

from __future__ import annotations

from owtsweep.studies.blade.schemes.mekf import NavigatorScheme

SCHEME = NavigatorScheme("MEKF_OFFSET", offset=True)
