"""Makes records: motion and sensor noise at one natural period, for a few replicates.

In a given replicate of a given natural period, the phases of the motion and the noise are the same
for all schemes and amplitudes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.source import Motion
from owtsweep.motion.spectra import Spectrum, spectrum
from owtsweep.motion.synthesis import SpectralSource
from owtsweep.streams import stream
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Sensors

STUDY = "hub"
#: Greatest number of bytes of motion that a worker holds at a time. If a block's replicates need
#: more, they run in several parts. Eight records of up to 6600 s at 100 Hz fit.
MEMORY_SHARE = 128_000_000
#: Bytes per step: position, velocity and acceleration, eight bytes each.
BYTES_PER_STEP = 24


@dataclass(frozen=True)
class Records:
    """The records of some replicates: motion of unit amplitude, and sensor noise.

    Attributes
    ----------
    config
        The configuration of the study.
    natural_period, spectrum
        Natural period (s) and spectrum of the motion.
    sensors
        What estimators may know about the sensors.
    replicates
        The numbers of the replicates, in order.
    direction
        Unit vector (2,) along the wave, north and east.
    """

    config: HubConfig
    natural_period: float
    spectrum: Spectrum
    sensors: Sensors
    replicates: tuple[int, ...]
    direction: Array

    @property
    def steps(self) -> int:
        """The number of IMU steps of a record."""
        return round(self.config.record.duration / self.sensors.step)

    def parts(self) -> Iterator[Records]:
        """Yield records of fewer replicates, so that their motion fits into `MEMORY_SHARE` bytes.

        All yielded `Records` together hold all replicates, in order. Each of them makes its motion
        at first use; deleting it frees the memory. If all replicates fit at once, yield `self`.
        """
        count = len(self.replicates)
        each = max(MEMORY_SHARE // (BYTES_PER_STEP * self.steps), 1)
        if each >= count:
            yield self
            return
        for first in range(0, count, each):
            yield replace(self, replicates=self.replicates[first : first + each])

    @cached_property
    def motion(self) -> tuple[Motion, ...]:
        """The motions, one per replicate, scaled to an amplitude of 1 m."""
        low, high = self.config.band
        source = SpectralSource(self.spectrum, (low, high), self.config.normalise)
        sensors = self.sensors
        return tuple(
            sensing.feel(
                source.realise(
                    self.stream(index), steps=self.steps, step=sensors.step, history=sensors.delay
                ),
                sensors,
            )
            for index in range(len(self.replicates))
        )

    @cached_property
    def noise(self) -> tuple[sensing.Measurements, ...]:
        """The noise of each replicate: all parts of the measurements that are not due to motion.

        The noise is made at first use and kept in memory.
        """
        return tuple(
            sensing.noise(self.config.sensors, self.sensors, self.steps, self.stream(index))
            for index in range(len(self.replicates))
        )

    @property
    def keeps_noise(self) -> bool:
        """Whether the property `noise` has been used, so that the noise is kept in memory."""
        return "noise" in vars(self)

    def force_noise(self, index: int) -> sensing.ForceNoise:
        """Return a source that draws the noise of a replicate's specific force piece by piece.

        `index` is the place of the replicate in `replicates`.
        """
        return sensing.ForceNoise(self.config.sensors, self.sensors, self.stream(index))

    def fix_noise(self, index: int) -> Array:
        """Draw the noise of a replicate's position fixes, m, shape (fixes, 2).

        `index` is the place of the replicate in `replicates`.
        """
        return sensing.fix_noise(self.sensors, self.steps, self.stream(index))

    def stream(self, index: int) -> Callable[[str], np.random.Generator]:
        """Return a function that takes a name and returns the replicate's random stream `name`.

        `index` is the place of the replicate in `replicates`. The names are those that
        `ForceNoise`, `fix_noise` and the motion ask for, e.g. "gnss".
        """
        return partial(
            stream, self.config.seed, STUDY, (self.natural_period,), self.replicates[index]
        )


def make_records(config: HubConfig, natural_period: float, replicates: Sequence[int]) -> Records:
    """Return the records of one natural period (s) and some replicates.

    Motion and noise are made at first use.
    """
    angle = np.deg2rad(config.wave_direction)
    return Records(
        config=config,
        natural_period=natural_period,
        spectrum=spectrum(config.spectrum.kind, natural_period, config.spectrum.bandwidth),
        sensors=sensing.sensors(config.sensors),
        replicates=tuple(replicates),
        direction=np.array([np.cos(angle), np.sin(angle)]),
    )
