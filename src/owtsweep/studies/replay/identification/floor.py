"""Read the IMU's white noise from the upper half of its own spectrum, where no hub moves."""

from __future__ import annotations

import numpy as np
from scipy.signal import welch

from owtsweep.arrays import Array

#: Samples per spectrum that is averaged, and the least number of these spectra.
SAMPLES, LEAST_SPECTRA = 512, 8
#: Edges of the quarters of the upper half, relative to the Nyquist frequency.
QUARTERS = (0.5, 0.6, 0.7, 0.8, 0.9)
#: Largest deviation of a quarter's level from their mean with which the spectrum counts as flat.
FLAT = 0.15


def measure_floor(force: Array) -> float:
    """Return the standard deviation of white noise with the level of the upper half spectrum.

    Parameters
    ----------
    force
        Samples of the specific force, shape (n, 2), in m/s^2.

    Returns
    -------
    float
        The deviation per sample and axis, m/s^2; NaN if the samples are few, or the spectrum is not
        flat there: then it holds more than white noise.
    """
    if len(force) < LEAST_SPECTRA * SAMPLES:
        return np.nan
    # a sampling rate of 2 makes the Nyquist frequency 1, and the level the variance
    frequency, power = welch(force, fs=2.0, nperseg=SAMPLES, axis=0)
    edges = np.searchsorted(frequency, QUARTERS)
    levels = np.array([np.mean(part) for part in np.split(power, edges)[1:-1]])
    level = float(np.mean(levels))
    if level <= 0.0 or np.max(np.abs(levels / level - 1.0)) > FLAT:
        return np.nan
    return float(np.sqrt(level))
