"""Seas of a few peaks, and how likely a stretch of measurements makes them.

A peak is a spectrum of Eq. (1) of Ren et al. (2019), translated, from a grid of natural periods,
half-bandwidths and variances. A sea is the sum of one peak or several. Its likelihood is that of
Whittle (1953, "Estimation and information in stationary time series", Ark. Mat. 2, 423), as in
`motion.whittle`, which fits one spectrum to a whole record.

The IMU shows little of a slow motion, because its acceleration is small. There, position fixes help
to see: the ordinates of both are added, weighted by their precisions, which for white noise on both
loses nothing of the likelihood.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.motion.ordinates import add_up
from owtsweep.motion.source import translated

#: Natural periods (s), squared half-bandwidths (s^-2) and variances (m^2) of the peaks. At 3.5 s,
#: neighbouring periods are as far apart as the narrowest peak is wide.
PERIODS = tuple(np.geomspace(2.2, 11.0, 43).tolist())
BANDWIDTHS = (3e-5, 3e-4, 3e-3)
VARIANCES = tuple(np.geomspace(1e-4, 30.0, 20).tolist())
#: Number of ordinates of a periodogram with a Hann window that tell as much as one independent
#: ordinate: the ratio of the window's noise bandwidth to the distance of the ordinates. And the
#: mean square of the window.
HANN, HANN_SQUARE = 1.5, 0.375
_SIZES, _LOGS = np.array(VARIANCES), np.log(VARIANCES)


class Candidate(NamedTuple):
    """A peak, as indices in the three grids."""

    period: int
    bandwidth: int
    variance: int

    @property
    def values(self) -> tuple[float, float, float]:
        """The natural period (s), the squared half-bandwidth (s^-2) and the variance (m^2)."""
        return PERIODS[self.period], BANDWIDTHS[self.bandwidth], VARIANCES[self.variance]


#: The sum of some peaks.
Sea = tuple[Candidate, ...]


class Force(NamedTuple):
    """What is known of the specific force along an axis, averaged over blocks of samples.

    step: time from one mean to the next, s.
    noise: one-sided density of the white noise, (m/s^2)^2/Hz.
    lean: specific force by leaning, s^-2: the specific force is the acceleration minus `lean` times
        the displacement.
    band: edges of the band of the motion, Hz.
    """

    step: float
    noise: float
    lean: float
    band: tuple[float, float]


class Fixes(NamedTuple):
    """What is known of position fixes along an axis.

    step, delay: time between fixes, and age of the position that a fix reports, s.
    sigma: standard deviation of the white noise, m.
    red, time: standard deviation (m) and correlation time (s) of the red noise.
    """

    step: float
    delay: float
    sigma: float
    red: float
    time: float


class Stretch:
    """The motion along one axis in some time, as it was measured.

    force: specific force, m/s^2, shape (n,). A constant in it does not matter.
    fixes: position fixes of the same time, m, shape (m,), and what is known of them; None: unused.
    """

    def __init__(
        self, force: Array, of_force: Force, fixes: tuple[Array, Fixes] | None = None
    ) -> None:
        self._models = models = _make_models(len(force), of_force, fixes and fixes[1])
        step = of_force.step
        #: Fourier integral of the force, m/s, at all ordinates. The middle of a block of samples is
        #: half a block after its beginning.
        self.of_force = transform(force, step, 0.5 * step)
        lines = self.of_force[models.inside].copy()
        if fixes is not None:
            values, known = fixes
            count = len(models.gain)
            of_fixes = transform(values, known.step, -known.delay)[models.inside][:count]
            weighed = lines[:count] / of_force.noise + of_fixes / (models.gain * models.fix_noise)
            lines[:count] = weighed * models.noise[:count]
        self._periodogram = compute_periodogram(lines, len(force) * step)

    def compute_log_likelihood(self, sea: Sea) -> float:
        """Compute the log likelihood of a sea, up to a constant."""
        density = self._sum(sea)
        return float(-np.sum(np.log(density) + self._periodogram / density) / HANN)

    def try_peaks(self, beside: Sea = (), shape: tuple[int, ...] = ()) -> Array:
        """Compute the log likelihood of all peaks, each together with those of another sea.

        The shape of the result is (periods, bandwidths, variances), or (variances,) for the peaks
        of one shape: the indices of its period and bandwidth.
        """
        models = self._models
        if not beside:
            terms = models.constant[shape] + models.inverse[shape] @ self._periodogram
        else:
            terms = np.zeros_like(models.constant[shape])
            shapes = models.shapes[shape].reshape(-1, len(models.noise))
            sums = terms.reshape(len(shapes), -1)
            add_up(shapes, _SIZES, self._sum(beside), self._periodogram, sums)
        return np.asarray(-terms / HANN)

    def size(self, sea: Sea) -> Sea:
        """Return the sea with other variances: of peak after peak, the mean that is likely.

        The likeliest variance would be too small as often as too large, but costs more where it is
        too small.
        """
        for i, peak in enumerate(sea):
            likelihood = self.try_peaks((*sea[:i], *sea[i + 1 :]), peak[:2])
            sea = (*sea[:i], Candidate(*peak[:2], _find_mean(likelihood)), *sea[i + 1 :])
        return sea

    def find_missing(self, sea: Sea) -> tuple[tuple[int, int], float]:
        """Return the shape of the peak that a sea misses most, and by how many deviations.

        That is Rao's score test, of a little more variance of that shape.
        """
        density, models = self._sum(sea), self._models
        spread = np.sqrt(HANN * (models.squares @ density**-2.0))
        scores = models.shapes @ ((self._periodogram / density - 1.0) / density) / spread
        period, bandwidth = map(int, np.unravel_index(int(scores.argmax()), scores.shape))
        return (period, bandwidth), float(scores[period, bandwidth])

    def _sum(self, sea: Sea) -> Array:
        models = self._models
        return sum(
            (VARIANCES[peak.variance] * models.shapes[peak[:2]] for peak in sea), models.noise
        )


def pick(likelihood: Array) -> Candidate:
    """Return the likeliest peak, given the log likelihood of all, as `Stretch.try_peaks` does."""
    return Candidate(*map(int, np.unravel_index(int(likelihood.argmax()), likelihood.shape)))


def transform(values: Array, step: float, first: float) -> NDArray[np.complex128]:
    """Return the Fourier integral of samples (n,), less their mean, with a Hann window.

    first: what the first sample is of, in s after the window begins.
    """
    window, turns = _make_window(len(values), step, first)
    return np.asarray(step * np.fft.rfft((values - values.mean()) * window) * turns)


def compute_periodogram(lines: NDArray[np.complex128], time: float) -> Array:
    """Compute the one-sided periodogram at ordinates of `transform`, over a time in s."""
    return np.asarray((lines.real**2 + lines.imag**2) * (2.0 / (HANN_SQUARE * time)))


@lru_cache(64)
def _make_window(count: int, step: float, first: float) -> tuple[Array, NDArray[np.complex128]]:
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * (np.arange(count) + first / step) / count)
    omega = 2.0 * np.pi * np.fft.rfftfreq(count, step)
    return window, np.exp(-1j * omega * first)


def find_ordinates(frequency: Array, low: float, high: float) -> slice[int]:
    """Return where rising frequencies, Hz, (n,) are between two, inclusive."""
    return slice(
        int(np.searchsorted(frequency, low)), int(np.searchsorted(frequency, high, "right"))
    )


class _Models(NamedTuple):
    """What all peaks make of the ordinates inside the band, in units of force.

    inside: where the ordinates are.
    shapes, squares: densities of the peaks for a variance of 1 m^2, and their squares, (periods,
        bandwidths, ordinates).
    noise: density of the noise.
    inverse, constant: 1 / density of each peak with the noise, (periods, bandwidths, variances,
        ordinates), and the sum of its log densities.
    gain, fix_noise: force per displacement, s^-2, and the density of the fixes' noise, m^2/Hz, at
        the first ordinates, for which fixes are used.
    """

    inside: slice[int]
    shapes: Array
    squares: Array
    noise: Array
    inverse: Array
    constant: Array
    gain: Array
    fix_noise: Array


@lru_cache(24)
def _make_models(length: int, force: Force, fixes: Fixes | None) -> _Models:
    frequency = np.fft.rfftfreq(length, force.step)
    inside = find_ordinates(frequency, *force.band)
    frequency = frequency[inside]
    omega = 2.0 * np.pi * frequency
    # averaging over a step weakens the force a little
    gain = -(omega**2 + force.lean) * np.sinc(frequency * force.step)
    shapes = np.empty((len(PERIODS), len(BANDWIDTHS), len(frequency)))
    for (i, period), (j, bandwidth) in product(enumerate(PERIODS), enumerate(BANDWIDTHS)):
        area = _integrate(period, bandwidth, force.band)
        shapes[i, j] = gain**2 * translated(period, bandwidth).density(frequency) / area
    noise: Array = np.full(len(frequency), force.noise)
    count, fix_noise = 0, np.zeros_like(noise)
    if fixes is not None:
        # above, motion of the band's upper part is folded back
        highest = min(force.band[1], 1.0 / fixes.step - force.band[1])
        count = int(np.searchsorted(frequency, highest))
        red = 4.0 * fixes.time / (1.0 + (omega[:count] * fixes.time) ** 2)
        fix_noise = 2.0 * fixes.sigma**2 * fixes.step + fixes.red**2 * red
        noise[:count] = 1.0 / (1.0 / force.noise + 1.0 / (gain[:count] ** 2 * fix_noise))
    models = shapes[:, :, None] * _SIZES[:, None] + noise
    constant = np.log(models).sum(axis=-1)
    given = gain[:count], fix_noise
    return _Models(inside, shapes, shapes**2, noise, 1.0 / models, constant, *given)


@lru_cache(1024)
def _integrate(period: float, bandwidth: float, band: tuple[float, float]) -> float:
    fine = np.linspace(*band, 4096)
    return float(np.trapezoid(translated(period, bandwidth).density(fine), fine))


def _find_mean(likelihood: Array) -> int:
    """Return the index of the variance nearest to the mean, given the log likelihood of each."""
    weights = np.exp(likelihood - likelihood.max())
    mean = weights @ _SIZES / weights.sum()
    return int(np.argmin(np.abs(_LOGS - np.log(mean))))
