"""MEKF_LEVER: MEKF with the error of the antenna's place as states."""

from __future__ import annotations

from owtsweep.studies.blade.schemes.mekf import NavigatorScheme

SCHEME = NavigatorScheme("MEKF_LEVER", lever=True)
