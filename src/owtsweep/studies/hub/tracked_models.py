"""Makes the models of the candidates among which SKFA chooses, and their gains.

The candidates are those of `motion.tracking`. A fitted shaping filter is kept in the cache folder,
because there are some hundred.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import changed
from owtsweep.errors import require
from owtsweep.estimation.late_gains import TOLERANCE, LateRows
from owtsweep.motion.shaping import FEWEST, ShapingFilter, fit_shaping_filter
from owtsweep.motion.spectra import translated
from owtsweep.motion.tracking import VARIANCES, Candidate
from owtsweep.studies.hub.known import Sensors
from owtsweep.studies.hub.known_motion import find_noise_density
from owtsweep.studies.hub.scheme_sections import Skf
from owtsweep.studies.hub.spectral_axis import LONGEST_TRANSIENT, SpectralAxis, make_axis
from owtsweep.studies.hub.spectral_model import FLOOR, fit_or_recall

#: Number of states of a candidate's shaping filter. The true spectrum is not known, so a closer fit
#: to a candidate does not lower the error.
STATES = 8
#: The model that assumes next to nothing: its variance, m^2, and the frequency up to which its
#: acceleration is white, as a multiple of the band's upper edge. From the band's lower edge on, its
#: position falls with f^-4. With these values its stated error is within 1 % of the Kalman bound
#: for the default sensors. A wider band adds the error of not knowing the force between samples.
WIDE_VARIANCE, WIDE = 10.0, 4.0
#: Number of neighbouring variances that share a fit: variances matter to it only by the floor.
SHARED = 3


@lru_cache(256)
def make_candidate(
    candidate: Candidate | None,
    bias_variance: float,
    tuning: Skf,
    sensors: Sensors,
    band: tuple[float, float],
) -> SpectralAxis:
    """Make the model of one axis for a candidate.

    Parameters
    ----------
    candidate
        Natural period, bandwidth and variance, as indices; None for a model that assumes next to
        nothing of the motion.
    bias_variance
        Variance of the bias at the start, (m/s^2)^2.
    tuning
        The section `skf` of the configuration.
    sensors
        The properties of IMU and GNSS.
    band
        Edges of the band of the motion, Hz.
    """
    tuning = changed(tuning, bias_variance=bias_variance)
    if candidate is None:
        return make_axis(_make_wide(band), WIDE_VARIANCE, tuning, sensors)
    group = candidate.variance // SHARED
    shaping = _fit(candidate.period, candidate.bandwidth, group, sensors, band)
    return make_axis(shaping, candidate.values[2], tuning, sensors)


@lru_cache(48)
def find_gains(axis: SpectralAxis) -> GrowingGains:
    """Return the gains of a model; they are shared, and take 1 MB per 9000 steps."""
    return GrowingGains(axis)


@lru_cache(512)
def _fit(
    period: int, bandwidth: int, group: int, sensors: Sensors, band: tuple[float, float]
) -> ShapingFilter:
    """Fit the shaping filter of a candidate's spectrum, for a group of `SHARED` variances."""
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


#: Least number of steps that are computed at a time: long enough for the minute that a new model
#: filters again, and short enough (3 ms) for an estimator on board.
CHUNK = 8192


class GrowingGains:
    """The gains of a model, which grow until they repeat.

    Parameters
    ----------
    axis
        The model, with a state of N numbers.
    """

    def __init__(self, axis: SpectralAxis) -> None:
        N = len(axis.first)
        self._axis, self._filled, self._repeats = axis, 0, False
        self._covariance, self._before = axis.first.copy(), np.full((N, N), np.nan)
        self._rows = LateRows(np.empty((0, N)), np.empty((0, N)), np.empty(0), np.empty((0, 2, 2)))

    def find(self, steps: int) -> LateRows:
        """Return the gains of at least the first `steps` steps, or of fewer if they repeat.

        After the last row, at the latest after `LONGEST_TRANSIENT` steps, the
        rows of the last fix interval repeat for ever.

        Raises
        ------
        InputError
            If a variance becomes negative or not finite, because the numbers of the model differ
            too much in magnitude.
        """
        while self._filled < min(steps, LONGEST_TRANSIENT) and not self._repeats:
            self._grow()
        return self._rows

    def _grow(self) -> None:
        from owtsweep.estimation.late import late_recursion

        axis, interval = self._axis, self._axis.model.interval
        fixes = -(-min(CHUNK, LONGEST_TRANSIENT - self._filled) // interval)
        more = fixes * interval, fixes, fixes, fixes * interval
        rows = LateRows(
            *(_lengthen(array, count) for array, count in zip(self._rows, more, strict=True))
        )
        first, stop = self._filled, len(rows.fast)
        filled, self._repeats = late_recursion(
            first, stop, axis.model, self._covariance, axis.outputs, TOLERANCE, self._before, rows
        )
        variances = np.diagonal(rows.outputs[first:filled], axis1=1, axis2=2)
        require(
            bool(np.all(np.isfinite(variances) & (variances > 0.0))),
            "skf: the filter's covariance is negative or infinite, because the variances of "
            "motion, sensors and bias differ too much in magnitude; use less extreme values",
        )
        if self._repeats:
            kept = filled, filled // interval, filled // interval, filled
            rows = LateRows(*(array[:n].copy() for array, n in zip(rows, kept, strict=True)))
        self._rows, self._filled = rows, filled


def _lengthen(array: Array, count: int) -> Array:
    """Return a copy of an array with `count` rows more, to be filled."""
    return np.concatenate([array, np.empty((count, *array.shape[1:]))])
