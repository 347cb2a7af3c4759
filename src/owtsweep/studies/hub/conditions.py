"""The axes of the hub study's grid: the turbine's natural period and how far its hub moves."""

from __future__ import annotations

from owtsweep.results.conditions import Condition

CONDITIONS = (
    Condition("natural_period", "natural period", "s", in_streams=True),
    Condition("amplitude", "motion amplitude", "m", scale="log", expands=True),
)
