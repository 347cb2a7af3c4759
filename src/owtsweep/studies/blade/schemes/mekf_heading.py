"""MEKF_HEADING: MEKF with a second antenna 20 m along the blade, which shows the heading."""

from __future__ import annotations

from owtsweep.studies.blade.schemes.mekf import NavigatorScheme

SCHEME = NavigatorScheme("MEKF_HEADING", antennas=2)
