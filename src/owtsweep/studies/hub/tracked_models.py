"""Makes the models of the seas among which SKFA chooses.

A sea is a sum of peaks (`motion.candidates`), so its model has the shaping filters of all of them,
side by side. A fitted shaping filter is kept in the cache folder, because there are some hundred.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import changed
from owtsweep.gravity import GRAVITY
from owtsweep.motion.candidates import VARIANCES, Candidate, Sea
from owtsweep.motion.shaping import FEWEST, ShapingFilter, fit_shaping_filter
from owtsweep.motion.source import translated
from owtsweep.studies.hub.known_motion import find_noise_density
from owtsweep.studies.hub.scheme_sections import Skf
from owtsweep.studies.hub.sensors import Sensors
from owtsweep.studies.hub.spectral_model import FLOOR, SpectralAxis, fit_or_recall, make_axis

#: Number of states of a peak's shaping filter. The true spectrum is not known, so a closer fit to a
#: peak does not lower the error.
STATES = 8
#: The model that assumes next to nothing: its variance, m^2, and the frequency up to which its
#: acceleration is white, as a multiple of the band's upper edge. From the band's lower edge on, its
#: position falls with f^-4. With these values its stated error is within 1 % of the Kalman bound
#: for the default sensors. A wider band adds the error of not knowing the force between samples.
WIDE_VARIANCE, WIDE = 10.0, 4.0
#: Number of neighbouring variances that share a fit: variances matter to it only by the floor.
SHARED = 3


@lru_cache(96)  # their gains take 1 to 3 MB per 9000 steps
def make_sea_model(
    sea: Sea | None,
    bias_variance: float,
    tuning: Skf,
    sensors: Sensors,
    band: tuple[float, float],
    red: float | None = None,
    lean: float | None = None,
    white: float = 1.0,
) -> SpectralAxis:
    """Make the model of one axis for a sea; None: one that assumes next to nothing of the motion.

    bias_variance: of the bias at the start, (m/s^2)^2.
    band: edges of the band of the motion, Hz.
    red, lean: standard deviation of the fixes' red noise, m, and specific force by leaning, s^-2;
        None: as the tuning says.
    white: the white noise of fixes over what it is said to be.
    """
    tuning = changed(tuning, bias_variance=bias_variance)
    told = replace(sensors, position_sigma=white * sensors.position_sigma)
    if lean is not None:
        tuning = changed(tuning, tilt=lean / GRAVITY)
    if sea is None:
        return make_axis([(_make_wide(band), WIDE_VARIANCE)], tuning, told, red)
    peaks = [
        (_fit(peak.period, peak.bandwidth, peak.variance // SHARED, sensors, band), peak.values[2])
        for peak in sea
    ]
    return make_axis(peaks, tuning, told, red)


@lru_cache(512)
def _fit(
    period: int, bandwidth: int, group: int, sensors: Sensors, band: tuple[float, float]
) -> ShapingFilter:
    """Fit the shaping filter of a peak, for a group of `SHARED` variances."""
    middle = min(SHARED * group + SHARED // 2, len(VARIANCES) - 1)
    natural_period, k, variance = Candidate(period, bandwidth, middle).values
    frequency = _choose_frequencies(1.0 / natural_period, float(np.sqrt(k)), band)
    inside = (frequency >= band[0]) & (frequency <= band[1])
    density = np.where(inside, translated(natural_period, k).density(frequency), 0.0)
    floor = FLOOR * find_noise_density(sensors, frequency) / variance
    return fit_or_recall(frequency, density, STATES, floor)


@lru_cache(8)
def _make_wide(band: tuple[float, float]) -> ShapingFilter:
    """Make the shaping filter of the model that assumes next to nothing of the motion."""
    low, high = band[0], WIDE * band[1]
    frequency = np.geomspace(low / 20.0, 20.0 * high, 400)
    density = 1.0 / ((1.0 + (frequency / low) ** 4) * (1.0 + (frequency / high) ** 4))
    # the floor is far below the density wherever the motion may be
    floor = 1e-6 * density[np.searchsorted(frequency, high)]
    return fit_shaping_filter(frequency, density, FEWEST, floor)


def _choose_frequencies(peak: float, half_bandwidth: float, band: tuple[float, float]) -> Array:
    """Return frequencies, Hz, (m,): dense at the peak, and reaching beyond the band."""
    low, high = band
    around = peak + half_bandwidth * np.sinh(np.linspace(-3.0, 3.0, 81))
    parts = [
        np.geomspace(low / 10.0, low, 20),
        np.linspace(low, high, 121),
        np.geomspace(high, 4.0 * high, 40),
        around[(around > low) & (around < high)],
    ]
    frequency = np.unique(np.concatenate(parts))
    # two frequencies that nearly coincide tell nothing more, and have no width
    is_apart = np.concatenate([[True], np.diff(frequency) > 1e-3 * half_bandwidth])
    return np.asarray(frequency[is_apart])
