"""Motions that a filter made for one steady spectrum does not expect.

Their amplitude grows and falls, they run faster or slower, are stretched in time, or have several
peaks. Each is a source along one direction, made of another source or of spectra.

A modulation is a factor over time. As one on the displacement d(t) it is e(t) > 0; velocity and
acceleration are the exact derivatives of the product e d.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.motion.source import DerivedSource, Motion, Normalise, Spectrum, find_size
from owtsweep.streams import Streams

#: Number of steps that are modulated at once, so that long records need no second copy.
AT_ONCE = 65536
#: Samples that a paced motion has beyond its ends, for the spline.
MARGIN = 4


class Modulation:
    """A factor on the displacement, over time, through given points.

    Between the points the factor's logarithm is interpolated by PCHIP, the monotone cubic Hermite
    interpolation of Fritsch and Butland (1984): a sea that grows tenfold grows by equal ratios in
    equal times. The factor is always positive, never leaves the range of its two neighbours, and
    its rate is continuous. Its second derivative, and so the acceleration, jumps at the points.
    Before the first point and after the last one the factor is constant. Raise `InputError` if
    there is no point, an entry is not two finite numbers, times do not rise, or a factor is not
    above zero.

    `points`: pairs of time (s) and factor; times rise, factors are above zero. `name`: the name of
    the points in error messages.
    """

    def __init__(self, points: Sequence[Sequence[float]], name: str = "envelope") -> None:
        from scipy.interpolate import PchipInterpolator

        _check(points, name)
        times, factors = np.array(points, dtype=float).T
        # Beyond the ends the factor is constant: points of equal height make PCHIP flat there.
        times = np.concatenate([[times[0] - 1.0], times, [times[-1] + 1.0]])
        factors = np.concatenate([factors[:1], factors, factors[-1:]])
        self._ends = (times[0], times[-1])
        self._log = PchipInterpolator(times, np.log(factors))
        self._rates = (self._log.derivative(1), self._log.derivative(2))

    def factor(self, time: Array) -> Array:
        """Return the factor at some times (s), of their shape."""
        return np.asarray(np.exp(self._log(np.clip(time, *self._ends))))

    def rates(self, time: Array) -> tuple[Array, Array]:
        """Return the factor's first (1/s) and second (1/s^2) derivative at some times (s).

        At a point itself the second derivative is that of the time after it.
        """
        at = np.clip(time, *self._ends)
        factor, first, second = self.factor(time), self._rates[0](at), self._rates[1](at)
        return factor * first, factor * (second + first**2)


def _check(points: Sequence[Sequence[float]], name: str) -> None:
    example = "give pairs of time (s) and factor, e.g. [[0,0.1],[500,10],[1000,0.1]]"
    require(len(points) > 0, f"{name}: there is no point; {example}")
    for point in points:
        fits = len(point) == 2 and bool(np.all(np.isfinite(point)))
        require(fits, f"{name}: {list(point)} is not two finite numbers; {example}")
        time, factor = point
        require(
            factor > 0.0,
            f"{name}: the factor {factor:g} at {time:g} s is not above zero; give a small factor "
            "instead, e.g. 0.01",
        )
    for (time, _), (later, _) in pairwise(points):
        require(
            time < later,
            f"{name}: the time {later:g} s does not come after {time:g} s; give the points in "
            "order of time",
        )


def modulate(motion: Motion, modulation: Modulation) -> Motion:
    """Multiply a motion along one direction by a factor over time.

    The arrays of `motion` are changed and become those of the result. `motion.felt` must be None.
    """
    if motion.felt is not None:
        raise ValueError("modulate the motion before an accelerometer feels it")
    steps, step = len(motion.position), motion.step
    for first in range(0, steps, AT_ONCE):
        part = slice(first, min(first + AT_ONCE, steps))
        time = step * np.arange(part.start, part.stop)
        e, (rate, bend) = modulation.factor(time), modulation.rates(time)
        p, v, a = motion.position[part], motion.velocity[part], motion.acceleration[part]
        a[:] = e * a + 2.0 * rate * v + bend * p
        v[:] = e * v + rate * p
        p[:] = e * p
    past = step * np.arange(-len(motion.before), 0)
    motion.before[:] *= modulation.factor(past)
    return motion


@dataclass(frozen=True)
class ModulatedSource(DerivedSource):
    """A source of motion along one direction, whose amplitude grows and falls."""

    modulation: Modulation

    def realise(self, stream: Streams, *, steps: int, step: float, history: int = 0) -> Motion:
        """Draw one record of the motion; arguments and errors are those of `Source.realise`."""
        motion = self.source.realise(stream, steps=steps, step=step, history=history)
        return modulate(motion, self.modulation)


@dataclass(frozen=True)
class PeakSum:
    """A spectrum with several peaks, each with an equal share of the variance."""

    peaks: tuple[Spectrum, ...]

    def density(self, frequency: Array) -> Array:
        """Compute the spectral density at evenly spaced frequencies, Hz; its sum is that of peaks.

        Only its shape matters. The shares are equal over the given frequencies.
        """
        parts = [peak.density(frequency) for peak in self.peaks]
        return np.asarray(sum(part / part.sum() for part in parts))


@dataclass(frozen=True)
class PacedSource(DerivedSource):
    """A source whose motion runs faster or slower, by a factor on its frequencies over time.

    The displacement is d(s(t)), where s' is the factor; its velocity is d' s' and its acceleration
    d'' s'^2 + d' s''. Before a record the factor is as at its start. `normalise` is as of
    `source.SpectralSource`.
    """

    pace: Modulation
    normalise: Normalise

    def realise(self, stream: Streams, *, steps: int, step: float, history: int = 0) -> Motion:
        """Draw one record of the motion; arguments and errors are those of `Source.realise`."""
        from scipy.interpolate import CubicSpline

        time = step * np.arange(steps)
        rate, (change, _) = self.pace.factor(time), self.pace.rates(time)
        moved = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]))])
        before = rate[0] * np.arange(-history, 0)
        lead = int(np.ceil(rate[0] * history)) + MARGIN
        whole = self.source.realise(
            stream, steps=int(np.ceil(moved[-1])) + MARGIN, step=step, history=lead
        )
        own = np.arange(len(whole.position))
        position = np.concatenate([whole.before, whole.position])
        d = CubicSpline(np.arange(-lead, len(own)), position)
        v, a = (CubicSpline(own, series)(moved) for series in (whole.velocity, whole.acceleration))
        paced = Motion(step, d(moved), v * rate, a * rate**2 + v * change, d(before))
        return rescale(paced, self.normalise)


@dataclass(frozen=True)
class StretchedSource(DerivedSource):
    """A source whose time is stretched by a factor, and its size set as a spectrum's is.

    `normalise` is as of `source.SpectralSource`.
    """

    factor: float
    normalise: Normalise

    @property
    def duration(self) -> float | None:
        own = self.source.duration
        return None if own is None else self.factor * own

    def realise(self, stream: Streams, *, steps: int, step: float, history: int = 0) -> Motion:
        """Draw one record of the motion; arguments and errors are those of `Source.realise`."""
        k = self.factor
        own = self.source.realise(stream, steps=steps, step=step / k, history=history)
        velocity, acceleration = own.velocity / k, own.acceleration / k**2
        return rescale(
            Motion(step, own.position, velocity, acceleration, own.before), self.normalise
        )


def rescale(motion: Motion, normalise: Normalise) -> Motion:
    """Return a motion whose largest displacement ("peak") or standard deviation ("rms") is 1 m."""
    size = find_size(motion.position, normalise)
    names = ("position", "velocity", "acceleration", "before")
    return replace(motion, **{name: getattr(motion, name) / size for name in names})
