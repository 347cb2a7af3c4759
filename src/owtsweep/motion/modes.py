"""Finds the peaks of a record's spectrum that are more than scatter, and their shares of variance.

The spectrum is smoothed by averaging over tapers (Riedel and Sidorenko, 1995, sine tapers) and, for
long records, over segments. A peak counts if its height above the valleys beside it is larger than
scatter explains. No shape is assumed, and no band: the whole spectrum is searched.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array

#: Number of tapers, and that for records shorter than `SHORT` s. More tapers scatter less, but
#: merge peaks that are near to each other.
TAPERS, TAPERS_OF_SHORT = 5, 3
SHORT = 120.0
#: Longer records are cut into segments of this duration, s.
SEGMENT = 300.0
#: A peak is more than scatter if scatter makes one as high, anywhere in a spectrum, with at most
#: this probability. Of 100 records of white noise each, 8 of 30 s, 2 of 60 s, 2 of 300 s and 17 of
#: 1000 s had such a peak. None of 320 records with one peak of Eq. (1) had a second one.
LEVEL = 0.05
#: Peaks with less of the variance are not listed.
LEAST_SHARE = 0.02


@dataclass(frozen=True)
class Mode:
    """A peak of a record's spectrum.

    frequency: In Hz: the mean over the part that is at least half as high as the top, weighted with
        the height.
    share: the share (0 to 1) of the record's variance between the valleys on either side of the
        peak.
    p: the probability that scatter makes such a peak anywhere in a spectrum without one.
    """

    frequency: float
    share: float
    p: float

    @property
    def period(self) -> float:
        """The period of the peak in s."""
        return 1.0 / self.frequency


@dataclass(frozen=True)
class Modes:
    """The peaks of a record's spectrum.

    `found`: the peaks, the one with the largest share of the variance first. `slow_share`: the
    share (0 to 1) of the variance at frequencies below `resolution`, where a period is too long for
    this record to tell. `resolution`: peaks nearer to each other, or to the frequency zero, than
    this are merged, Hz.
    """

    found: tuple[Mode, ...]
    slow_share: float
    resolution: float


def find_modes(position: Array, step: float) -> Modes:
    """Find the peaks of a record's spectrum that are more than scatter.

    `position`, in m, has the shape (n, axes); the spectra of the axes are added. `step` is in s.
    The peaks have at least `LEAST_SHARE` of the variance. There are none without motion, or with
    fewer than 16 samples.

    A smoothed spectrum at a frequency is chi-squared with nu = 2 * tapers * segments degrees of
    freedom. (The axes count once, because the motion may be along a line.) The ratio of two heights
    at different frequencies therefore follows an F distribution with (nu, nu) degrees of freedom.
    The ratio tested is that of a peak to the higher of two valleys: the lowest points to the left
    and to the right before the spectrum rises above the peak. The p-value is multiplied by the
    number of pairs of places for a peak and a valley (Bonferroni). The places are as wide as
    `Modes.resolution`, and lie below the frequency under which 99 % of the variance lies.
    """
    from scipy.signal import find_peaks
    from scipy.stats import f as f_distribution

    if len(position) < 16 or not np.any(np.ptp(position, axis=0) > 0.0):
        return Modes((), 0.0, np.nan)
    tapers = TAPERS if len(position) * step >= SHORT else TAPERS_OF_SHORT
    frequency, power, segments = smooth_spectrum(position, step, tapers)
    resolution = (tapers + 1) * float(frequency[0])
    slow_share = float(np.sum(power[frequency < resolution]) / np.sum(power))
    nu = 2 * tapers * segments
    height = np.log(np.maximum(power, 1e-20 * np.max(power)))
    # Removing the trend takes power from the first lines, which are no valley therefore.
    height[: tapers // 2] = height[tapers // 2]
    below = np.searchsorted(np.cumsum(power), (1.0 - 0.5 * LEAST_SHARE) * np.sum(power))
    pairs = max(float(frequency[below]) / resolution, 1.0) ** 2
    least = np.log(f_distribution.isf(LEVEL / pairs, nu, nu))
    # A spectrum that falls from its first line on has a peak there: motion too slow to resolve.
    padded = np.concatenate([[height.min()], height, [height.min()]])
    at, properties = find_peaks(padded, prominence=least)
    at, prominence = np.maximum(at - 1, 0), properties["prominences"]
    if len(at) == 0:
        return Modes((), slow_share, resolution)
    valleys = [a + int(np.argmin(height[a:b])) for a, b in itertools.pairwise(at)]
    shares = np.add.reduceat(power, [0, *valleys]) / np.sum(power)
    p = np.minimum(pairs * f_distribution.sf(np.exp(prominence), nu, nu), 1.0)
    slow, enough = frequency[at] < resolution, shares >= LEAST_SHARE
    found = [
        Mode(_locate(frequency, power, i), float(share), float(chance))
        for i, share, chance in zip(
            *(series[enough & ~slow] for series in (at, shares, p)), strict=True
        )
    ]
    found.sort(key=lambda mode: -mode.share)
    return Modes(tuple(found), slow_share, resolution)


def _locate(frequency: Array, power: Array, top: int) -> float:
    """Return the frequency (Hz) of the peak at the index `top`.

    A line spectrum's peak is as wide as the tapers make it, and flat: its middle counts.
    """
    low = np.flatnonzero(power < 0.5 * power[top])
    begin = int(np.max(low[low < top], initial=-1)) + 1
    end = int(np.min(low[low > top], initial=len(power)))
    return float(np.average(frequency[begin:end], weights=power[begin:end]))


def smooth_spectrum(position: Array, step: float, tapers: int) -> tuple[Array, Array, int]:
    """Return the frequencies (Hz) and heights of a smoothed spectrum, and the number of segments.

    `position` has the shape (n, axes); `step` is in s. Mean and linear trend of each segment are
    removed. Only ratios of heights have a meaning.
    """
    from scipy.signal import detrend

    segments = max(round(len(position) * step / SEGMENT), 1)
    n = len(position) // segments
    wave = np.pi * np.arange(1, n + 1) / (n + 1)
    power = np.zeros(n // 2 + 1)
    for number in range(segments):
        part = detrend(position[number * n : (number + 1) * n], axis=0)
        for k in range(1, tapers + 1):
            lines = np.fft.rfft(part * np.sin(k * wave)[:, None], axis=0)
            power += np.sum(lines.real**2 + lines.imag**2, axis=1)
    return np.fft.rfftfreq(n, step)[1:], power[1:], segments
