"""Finds the spectrum of a motion while it goes on, from the specific force along an axis.

At each look, the likelihood of seas (`motion.candidates`) is computed from what was measured in the
last minutes. Their shape is taken from the last four minutes, and the variances from the last
minute alone, so that a sea that grows or falls is followed.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.motion.candidates import (
    Candidate,
    Fixes,
    Force,
    Sea,
    Stretch,
    compute_periodogram,
    find_ordinates,
    pick,
)

#: Time between two looks, the shortest record for a look, and the times from which the variance and
#: the shape are taken, s.
INTERVAL, LEAST, OF_VARIANCE, OF_SHAPE = 10.0, 30.0, 60.0, 240.0
#: Rate to which samples are averaged for the periodogram, Hz: far above the motion's frequencies.
RATE = 10.0
#: By how much the log likelihood must be greater before one more peak, or other variances, are
#: taken. That is less than chance alone would give (3 for a peak, by Akaike's criterion), because a
#: filter loses more by motion that it does not expect.
GAIN = 2.0
#: By how many standard deviations a peak must be missed before another sea is looked for, and
#: before that gets one more peak; and the most peaks of a sea.
MISSED, ADDED, MOST = 4.0, 3.0, 4
#: Where the estimate of the motion above the band begins, per upper edge of the band.
ABOVE = 1.5


class Motion(NamedTuple):
    """Variances of position (m^2) and velocity ((m/s)^2) of some part of a motion."""

    position: float
    velocity: float


class SpectrumTracker:
    """Chooses the sea that the measurements of the last minutes make likely.

    step: sampling interval of the specific force, s.
    force_sigma: standard deviation of a sample's white noise, m/s^2.
    lean: specific force by leaning, s^-2: the specific force is the acceleration minus `lean` times
        the displacement.
    band: edges of the band of the motion, Hz.
    """

    def __init__(
        self, step: float, force_sigma: float, lean: float, band: tuple[float, float]
    ) -> None:
        self._block = max(round(1.0 / (RATE * step)), 1)
        self._noise, self._band = 2.0 * force_sigma**2 * step, band
        self.step, self.lean = step * self._block, lean
        self.chosen: Sea | None = None
        #: The motion above the band at the last look, where no sea has any.
        self.above = Motion(0.0, 0.0)

    def average(self, force: Array) -> Array:
        """Return means over blocks of samples (n,), of which the last ends with the record."""
        block = self._block
        blocks = force[len(force) % block :].reshape(-1, block)
        return np.asarray(blocks @ np.full(block, 1.0 / block))

    def look(self, force: Array, fixes: tuple[Array, Fixes] | None = None) -> Sea | None:
        """Choose a sea; None if the record is shorter than `LEAST`.

        force: the specific force along one axis, m/s^2, as `average` returns it: all of it, or the
            last `OF_SHAPE` seconds or more. A constant in it does not matter.
        fixes: the fixes of that time, m, of which the last is a fix interval old, NaN where one was
            lost, and what is known of them; None: the force alone is looked at.
        """
        count = _find_length(len(force), self.step)
        if count is None:
            return None
        whole = self._cut(force, fixes, count)
        self.above = self._measure_above(whole.of_force, count)
        recent = self._cut(force, fixes, min(count, round(OF_VARIANCE / self.step)))
        now = self.chosen
        best = self._find(whole) if now is None or not _suffices(now, whole) else now
        sized = recent.size(best)
        if sized == now:
            return now
        if best == now:
            gain = recent.compute_log_likelihood(sized) - recent.compute_log_likelihood(now)
            if gain <= GAIN:
                return now
        self.chosen = sized
        return self.chosen

    def _cut(self, force: Array, fixes: tuple[Array, Fixes] | None, count: int) -> Stretch:
        """Return the stretch of the last `count` averaged samples, with its fixes if all came."""
        known = Force(self.step, self._noise, self.lean, self._band)
        if fixes is not None:
            values, of_fixes = fixes
            exact = count * self.step / of_fixes.step
            number = round(exact)
            last = values[len(values) - number :]
            if abs(exact - number) < 1e-6 and number <= len(values) and not np.isnan(last).any():
                return Stretch(force[-count:], known, (last, of_fixes))
        return Stretch(force[-count:], known)

    def _find(self, stretch: Stretch) -> Sea:
        """Return the likeliest sea: of one peak, and of more as long as one is clearly missed.

        A new peak moves the others, each in turn.
        """
        likelihood = stretch.try_peaks()
        best: Sea = (pick(likelihood),)
        greatest = float(likelihood.max())
        while len(best) < MOST:
            shape, deviations = stretch.find_missing(best)
            if deviations < ADDED:
                break
            sizes = stretch.try_peaks(best, shape)
            sea: Sea = (*best, Candidate(*shape, int(sizes.argmax())))
            for i in range(len(sea)):
                likelihood = stretch.try_peaks((*sea[:i], *sea[i + 1 :]))
                sea = (*sea[:i], pick(likelihood), *sea[i + 1 :])
            if likelihood.max() <= greatest + GAIN:
                break
            best, greatest = sea, float(likelihood.max())
        return best

    def _measure_above(self, lines: NDArray[np.complex128], length: int) -> Motion:
        """Estimate the motion above the band from the Fourier integral of averaged samples.

        The estimate begins at `ABOVE` times the band's upper edge, which a Hann window keeps free
        of what is inside the band. A variance may be slightly below zero, by chance.
        """
        above, second, fourth = _list_above(length, self.step, self._band[1])
        time = length * self.step
        excess = (compute_periodogram(lines[above], time) - self._noise) / time
        return Motion(float(np.sum(excess / fourth)), float(np.sum(excess / second)))


def _suffices(sea: Sea, stretch: Stretch) -> bool:
    """Return whether no peak is clearly missed in a sea, nor one peak would do as well."""
    sized = stretch.size(sea)
    if stretch.find_missing(sized)[1] >= MISSED:
        return False
    if len(sea) == 1:
        return True
    gain = stretch.compute_log_likelihood(sized) - stretch.try_peaks().max()
    return bool(gain > GAIN)


@lru_cache(64)
def _list_above(length: int, step: float, edge: float) -> tuple[slice[int], Array, Array]:
    """Return where the ordinates above an edge (Hz) are, and their (rad/s)^2 and (rad/s)^4."""
    frequency = np.fft.rfftfreq(length, step)
    above = find_ordinates(frequency, ABOVE * edge, 0.4 / step)
    omega = 2.0 * np.pi * frequency[above]
    return above, omega**2, omega**4


def _find_length(available: int, step: float) -> int | None:
    """Return how many samples are looked at: one of few numbers, as the models of each are kept."""
    times = (LEAST, OF_VARIANCE, 90.0, 120.0, 180.0, OF_SHAPE)
    return max((n for n in (round(time / step) for time in times) if n <= available), default=None)
