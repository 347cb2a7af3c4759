"""Measurements of given positions, and the lag of sines, for the tests of simple schemes."""

from __future__ import annotations

import numpy as np
from linear_records import STEP

from owtsweep.studies.floater.contract import Measured


def report(position, *, step=STEP, acceleration=None):
    """Return measurements of given positions, shape (steps,) or (steps, 6)."""
    position = np.asarray(position, dtype=float)
    if position.ndim == 1:
        position = np.repeat(position[:, None], 6, axis=1)
    steps = len(position)
    acceleration = np.zeros((steps, 6)) if acceleration is None else acceleration
    nothing = np.zeros(steps)
    return Measured(
        step, position, nothing, nothing > 0.0, acceleration, np.zeros((steps, 3)), None
    )


def find_lag(estimate, wanted, omega, *, step=STEP):
    """Return how much later in s a sine is in an estimate, and its size over the wanted one's."""
    wave = np.exp(-1j * omega * step * np.arange(len(wanted)))
    settled = slice(round(len(wanted) / 2), None)
    ratio = (wave * estimate)[settled].mean() / (wave * wanted)[settled].mean()
    return -np.angle(ratio) / omega, np.abs(ratio)
