"""PENDULUM: MEKF that knows how the hook lets the blade swing."""

from __future__ import annotations

from owtsweep.studies.blade.schemes.mekf import NavigatorScheme

SCHEME = NavigatorScheme("PENDULUM", swing=True)
