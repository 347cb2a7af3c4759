"""Finds how large the fixes' noise is: its red part, and the white one beside what is stated.

The motion has no part below its band, so what moves there is noise of the fixes. The size of its
red part is chosen by the Whittle likelihood of those ordinates of the fixes' periodogram, as
`motion.tracking` chooses the spectrum of the motion. Few ordinates lie there, so sizes are far
apart, and another size must be clearly more likely before it is taken. The white part is given:
so few ordinates cannot tell it from the red one.

A slow motion below the band is taken for noise of the fixes too.

The white part follows from how far off a filter's predictions of the fixes were.
"""

from __future__ import annotations

from functools import lru_cache
from math import ceil, log2

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.candidates import HANN, compute_periodogram, transform

#: Standard deviations of the red noise among which one is chosen, m.
SIZES = (0.0, 0.03, 0.1, 0.3)
#: Times from which the periodogram is made, s; the longest one for which there are fixes is used.
TIMES = (120.0, 240.0)
#: By how much the log likelihood of another size must be greater before it is taken.
GAIN = 5.0
#: Number of ordinates below the band into which much of a large motion leaks.
LEAKS = 3
#: How many fixes tell of the level of their white noise: the fewest, and the mean of their squared
#: scaled innovations if the level is right. Squares count up to the `HIGHEST`, so that few outliers
#: do not move the mean.
TELLING, HIGHEST, MEAN = 120, 4.0, 0.921
#: Between which powers of 2 that mean, over the right one, leaves the level as it is. A level that
#: is too low by the root of 2 makes a right spectrum seem wrong, and costs up to a factor of 3; one
#: that is as much too high, 2 %. With 120 fixes, the mean scatters by .16 of a power.
LOW, HIGH = -1.0, 0.5
#: The greatest level, and the least one's inverse. A greater misfit is no matter of fixes alone: an
#: IMU that feels nothing of a motion would be believed.
MOST = 4.0


class FixNoiseTracker:
    """Chooses the size of the fixes' red noise along an axis that the last minutes make likely.

    step: time between fixes, s.
    time: correlation time of the red noise, s.
    band: edges of the band of the motion, Hz.
    """

    def __init__(self, step: float, time: float, band: tuple[float, float]) -> None:
        self._step, self._given = step, (step, time, band[0])
        # where fixes are so seldom that motion of the band is folded to below it, nothing is seen
        self._sees = 1.0 / step >= sum(band)
        self._lengths = [round(time / step) for time in TIMES]
        self._chosen = 0.0

    def look(self, fixes: Array, sigma: float) -> float:
        """Choose a size, m, from the fixes (n,), m, that came since one was lost (NaN).

        sigma: standard deviation of the white noise, m.
        """
        lost = np.flatnonzero(np.isnan(fixes))
        count = len(fixes) - (lost[-1] + 1 if len(lost) else 0)
        lengths = [length for length in self._lengths if length <= count]
        if not self._sees or not lengths:
            return self._chosen
        whole = fixes[-lengths[-1] :]
        constant, inverse, below = _make_models(len(whole), sigma, *self._given)
        lines = transform(whole, self._step, 0.0)[below]
        periodogram = compute_periodogram(lines, len(whole) * self._step)
        likelihood = -(constant + inverse @ periodogram) / HANN
        best, now = int(likelihood.argmax()), SIZES.index(self._chosen)
        if likelihood[best] - likelihood[now] > GAIN:
            self._chosen = SIZES[best]
        return self._chosen

    def forget(self) -> float:
        """Choose no red noise, and return its size, 0 m."""
        self._chosen = 0.0
        return self._chosen


@lru_cache(16)
def _make_models(
    length: int, sigma: float, step: float, time: float, edge: float
) -> tuple[Array, Array, slice]:
    """Return sums of log densities (sizes,), 1 / densities, and the ordinates that they use."""
    frequency = np.fft.rfftfreq(length, step)
    below = slice(1, max(int(np.searchsorted(frequency, edge, "right")) - LEAKS, 1))
    red = 4.0 * time / (1.0 + (2.0 * np.pi * frequency[below] * time) ** 2)
    densities = 2.0 * sigma**2 * step + np.array(SIZES)[:, None] ** 2 * red
    return np.log(densities).sum(axis=-1), 1.0 / densities, below


def find_level(squares: Array, level: float) -> float:
    """Return the fixes' white noise over what is stated: a power of the root of 2, rounded up.

    squares: squares of scaled innovations (n,), NaN where there was no fix, of a filter that knew
        the level and that assumes next to nothing of the motion.
    level: that level; it stays unless it is clearly off.
    """
    squares = squares[~np.isnan(squares)]
    if len(squares) < TELLING:
        return level
    ratio = float(np.mean(np.minimum(squares, HIGHEST))) / MEAN
    power = log2(max(ratio, MOST**-4))  # it may be zero, of a file of zeros
    if LOW < power < HIGH:
        return level
    return float(min(max(level * 2.0 ** (0.5 * ceil(power)), 1.0 / MOST), MOST))
