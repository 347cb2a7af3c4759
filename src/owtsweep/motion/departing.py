"""Motions that a filter made for one steady spectrum does not expect: paced, stretched, two-peaked.

Each is a source along one direction, made of another source or of spectra.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.modulation import Modulation
from owtsweep.motion.source import DerivedSource, Motion
from owtsweep.motion.spectra import Spectrum
from owtsweep.motion.synthesis import Normalise, find_size
from owtsweep.streams import Streams

#: Samples that a paced motion has beyond its ends, for the spline.
MARGIN = 4


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
    `synthesis.SpectralSource`.
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

    `normalise` is as of `synthesis.SpectralSource`.
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
