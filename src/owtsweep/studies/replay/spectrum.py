"""The record's spectrum, and Eq. (1) fitted to it."""

from __future__ import annotations

from owtsweep.arrays import Array


def fit(d: Array, step: float, band: tuple[float, float]) -> dict[str, float] | None:
    return None
