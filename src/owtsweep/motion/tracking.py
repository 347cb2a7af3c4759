"""Finds the spectrum of a motion while it goes on, from the specific force along an axis.

The candidates are the spectra of Eq. (1) of Ren et al. (2019), translated, on a grid of natural
periods, half-bandwidths and variances. At each look, the likelihood of the candidates is computed
from the periodogram of the last minutes: the Whittle likelihood (Whittle 1953, "Estimation and
information in stationary time series", Ark. Mat. 2, 423), as in `motion.whittle`, which fits one
spectrum to a whole record. The shape is taken from the last four minutes, and the variance from the
last minute alone, so that a sea that grows or falls is followed.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import product
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.spectra import translated

#: Natural periods (s), squared half-bandwidths (s^-2) and variances (m^2) of the candidates.
PERIODS = tuple(np.geomspace(2.2, 11.0, 22).tolist())
BANDWIDTHS = (3e-5, 3e-4, 3e-3)
VARIANCES = tuple(np.geomspace(1e-4, 30.0, 20).tolist())
#: Time between two looks, the shortest record for a look, and the times from which the variance and
#: the shape are taken, s.
INTERVAL, LEAST, OF_VARIANCE, OF_SHAPE = 10.0, 30.0, 60.0, 240.0
#: Rate to which samples are averaged for the periodogram, Hz: far above the motion's frequencies.
RATE = 10.0
#: By how much another candidate's log likelihood must be greater before it is taken.
GAIN_OF_SHAPE, GAIN_OF_VARIANCE = 2.0, 1.0
#: Where the estimate of the motion above the band begins, per upper edge of the band.
ABOVE = 1.5
#: Number of ordinates of a periodogram with a Hann window that tell as much as one independent
#: ordinate: the ratio of the window's noise bandwidth to the distance of the ordinates.
HANN = 1.5


class Candidate(NamedTuple):
    """A spectrum of Eq. (1) and a variance, as indices in the three grids."""

    period: int
    bandwidth: int
    variance: int

    @property
    def values(self) -> tuple[float, float, float]:
        """The natural period (s), the squared half-bandwidth (s^-2) and the variance (m^2)."""
        return (
            PERIODS[self.period],
            BANDWIDTHS[self.bandwidth],
            VARIANCES[self.variance],
        )


class Motion(NamedTuple):
    """Variances of position (m^2) and velocity ((m/s)^2) of some part of a motion."""

    position: float
    velocity: float


class SpectrumTracker:
    """Chooses the candidate that the specific force of the last minutes makes likely.

    step: Sampling interval of the specific force, s.
    force_sigma: Standard deviation of a sample's white noise, m/s^2.
    lean: Specific force by leaning, s^-2: the specific force is the acceleration minus `lean` times
        the displacement.
    band: Edges of the band of the motion, Hz.
    """

    def __init__(
        self, step: float, force_sigma: float, lean: float, band: tuple[float, float]
    ) -> None:
        self._block = max(round(1.0 / (RATE * step)), 1)
        self._noise, self._band = 2.0 * force_sigma**2 * step, band
        self.step, self.lean = step * self._block, lean
        self.chosen: Candidate | None = None

    @property
    def _given(self) -> tuple[float, float, float, tuple[float, float]]:
        return self.step, self._noise, self.lean, self._band

    def average(self, force: Array) -> Array:
        """Return means over blocks of samples (n,), of which the last ends with the record."""
        block = self._block
        blocks = force[len(force) % block :].reshape(-1, block)
        return np.asarray(blocks @ np.full(block, 1.0 / block))

    def look(self, force: Array) -> Candidate | None:
        """Choose a candidate; None if the record is shorter than `LEAST`.

        `force` is the specific force along one axis, m/s^2, as `average` returns it: all of it, or
        the last `OF_SHAPE` seconds or more. A constant in it does not matter.
        """
        step = self._given[0]
        lengths = [n for n in _list_lengths(step) if n <= len(force)]
        if not lengths:
            return None
        last = round(OF_VARIANCE / step)
        best = compute_log_likelihood(force[-lengths[-1] :], *self._given).max(axis=2)
        recent = force[-min(lengths[-1], last) :]
        now = self.chosen
        if now is not None and best.max() - best[now[:2]] <= GAIN_OF_SHAPE:
            of_now = compute_log_likelihood(recent, *self._given, now[:2])
            if of_now.max() - of_now[now.variance] <= GAIN_OF_VARIANCE:
                return now
        period, bandwidth = map(int, np.unravel_index(int(best.argmax()), best.shape))
        of_variance = compute_log_likelihood(recent, *self._given, (period, bandwidth))
        self.chosen = Candidate(period, bandwidth, int(of_variance.argmax()))
        return self.chosen

    def measure_above(self, force: Array) -> Motion:
        """Estimate the motion above the band, where no candidate has any; `force` is as for `look`.

        The estimate begins at `ABOVE` times the band's upper edge, which a Hann window keeps free
        of what is inside the band. A variance may be slightly below zero, by chance.
        """
        step, noise, _, band = self._given
        above, second, fourth = _list_above(len(force), step, band[1])
        excess = (compute_periodogram(force, step, above) - noise) / (len(force) * step)
        return Motion(float(np.sum(excess / fourth)), float(np.sum(excess / second)))


def compute_periodogram(force: Array, step: float, ordinates: slice[int]) -> Array:
    """Compute some ordinates of the one-sided periodogram of samples (n,), with a Hann window.

    The result is in the samples' unit^2/Hz.
    """
    window, square = _make_window(len(force))
    lines = np.fft.rfft((force - force.mean()) * window)[ordinates]
    return np.asarray(np.abs(lines) ** 2 * (2.0 * step / square))


@lru_cache(64)
def _make_window(length: int) -> tuple[Array, float]:
    window = np.hanning(length)
    return window, float(np.sum(window**2))


def compute_log_likelihood(
    force: Array,
    step: float,
    noise: float,
    lean: float,
    band: tuple[float, float],
    shape: tuple[int, int] | tuple[()] = (),
) -> Array:
    """Compute the Whittle log likelihood of candidates, up to a constant.

    The shape is (periods, bandwidths, variances), or (variances,) for the candidates of one shape.

    force: Specific force, m/s^2, shape (n,).
    step: Sampling interval, s.
    noise: One-sided density of the white noise, (m/s^2)^2/Hz.
    lean, band: Specific force by leaning, s^-2, and edges of the band of the motion, Hz.
    shape: indices of the period and the bandwidth of the candidates; () for those of all shapes.
    """
    inverse, constant, inside = _make_models(len(force), step, noise, lean, band)
    periodogram = compute_periodogram(force, step, inside)
    return np.asarray(-(constant[shape] + inverse[shape] @ periodogram) / HANN)


@lru_cache(32)
def _make_models(
    length: int, step: float, noise: float, lean: float, band: tuple[float, float]
) -> tuple[Array, Array, slice[int]]:
    """Return 1 / density of all candidates, the sum of log densities, and the ordinates they use.

    The shapes are (periods, bandwidths, variances, ordinates) and (periods, bandwidths, variances).
    """
    frequency = np.fft.rfftfreq(length, step)
    inside = _find_ordinates(frequency, *band)
    frequency = frequency[inside]
    # averaging over a step weakens the force a little
    force = ((2.0 * np.pi * frequency) ** 2 + lean) ** 2 * np.sinc(frequency * step) ** 2
    fine = np.linspace(*band, 4096)
    shapes = np.empty((len(PERIODS), len(BANDWIDTHS), len(frequency)))
    for (i, period), (j, bandwidth) in product(enumerate(PERIODS), enumerate(BANDWIDTHS)):
        spectrum = translated(period, bandwidth)
        shapes[i, j] = spectrum.density(frequency) / np.trapezoid(spectrum.density(fine), fine)
    models = shapes[:, :, None] * np.array(VARIANCES)[:, None] * force + noise
    return 1.0 / models, np.log(models).sum(axis=-1), inside


@lru_cache(64)
def _list_above(length: int, step: float, edge: float) -> tuple[slice[int], Array, Array]:
    """Return where the ordinates above an edge (Hz) are, and their (rad/s)^2 and (rad/s)^4."""
    frequency = np.fft.rfftfreq(length, step)
    above = _find_ordinates(frequency, ABOVE * edge, 0.4 / step)
    omega = 2.0 * np.pi * frequency[above]
    return above, omega**2, omega**4


def _find_ordinates(frequency: Array, low: float, high: float) -> slice[int]:
    """Return where rising frequencies, Hz, (n,) are between two, inclusive."""
    return slice(
        int(np.searchsorted(frequency, low)), int(np.searchsorted(frequency, high, "right"))
    )


def _list_lengths(step: float) -> list[int]:
    """Return the numbers of samples of periodograms: few, because their models are kept."""
    return [round(seconds / step) for seconds in (LEAST, OF_VARIANCE, 90.0, 120.0, 180.0, OF_SHAPE)]
