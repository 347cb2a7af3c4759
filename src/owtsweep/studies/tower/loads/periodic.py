"""Samples series that repeat after twice a record, so that what came before a record is known."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array


def sample_periodic(bins: NDArray[np.complex128], steps: int, lead: int) -> Array:
    """Sample a series that repeats after twice the record, and a lead before it.

    Parameters
    ----------
    bins
        Lines at multiples of 1 / (2 steps step), from 0 on, as `numpy.fft.irfft` takes them.
    steps, lead
        Number of samples of the record, and of those before it, at most `steps`.

    Returns
    -------
    array
        Shape (lead + steps,).
    """
    period = np.fft.irfft(bins, 2 * steps)
    return np.concatenate([period[2 * steps - lead :], period[:steps]])
