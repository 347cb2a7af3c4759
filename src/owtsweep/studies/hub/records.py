"""The records of one block: motion and noise of one period and a few replicates.

All schemes and amplitudes of a (period, replicate) see the same phases and the same noise.
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
#: Most bytes of motion that a worker holds at a time. If a block's replicates need more, they run
#: in several parts. Eight records of up to 6600 s at 100 Hz fit.
MEMORY_SHARE = 128_000_000
#: Bytes per step: position, velocity and acceleration, eight bytes each.
BYTES_PER_STEP = 24


@dataclass(frozen=True)
class Records:
    """Motion of unit amplitude and noise of some replicates.

    Attributes
    ----------
    replicates
        Their numbers, in order.
    direction
        (2,): the wave's direction in NED.
    """

    config: HubConfig
    natural_period: float
    spectrum: Spectrum
    sensors: Sensors
    replicates: tuple[int, ...]
    direction: Array

    @property
    def steps(self) -> int:
        """IMU steps of a record."""
        return round(self.config.record.duration / self.sensors.step)

    def parts(self) -> Iterator[Records]:
        """Split the records into parts whose motion fits into a worker's share of memory.

        A part makes its motion at first use; the memory is freed with the part.
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
        """The motions, one per replicate, scaled to unit amplitude."""
        low, high = self.config.band
        source = SpectralSource(self.spectrum, (low, high), self.config.normalise)
        sensors = self.sensors
        return tuple(
            source.realise(
                self.stream(index), steps=self.steps, step=sensors.step, history=sensors.delay
            )
            for index in range(len(self.replicates))
        )

    @cached_property
    def noise(self) -> tuple[sensing.Measurements, ...]:
        """One per replicate: all of the measurements that is not motion, kept in memory."""
        return tuple(
            sensing.noise(self.config.sensors, self.sensors, self.steps, self.stream(index))
            for index in range(len(self.replicates))
        )

    @property
    def keeps_noise(self) -> bool:
        """Whether the whole noise has been made, and so is kept."""
        return "noise" in vars(self)

    def force_noise(self, index: int) -> sensing.ForceNoise:
        """The noise of the specific force of the replicate with this index, piece by piece."""
        return sensing.ForceNoise(self.config.sensors, self.sensors, self.stream(index))

    def fix_noise(self, index: int) -> Array:
        """(fixes, 2) noise of the fixes of the replicate with this index, m."""
        return sensing.fix_noise(self.sensors, self.steps, self.stream(index))

    def stream(self, index: int) -> Callable[[str], np.random.Generator]:
        """The random streams, by name, of the replicate with this index."""
        return partial(
            stream, self.config.seed, STUDY, (self.natural_period,), self.replicates[index]
        )


def make_records(config: HubConfig, natural_period: float, replicates: Sequence[int]) -> Records:
    """The records of one period and some replicates; motion and noise are made when needed."""
    angle = np.deg2rad(config.wave_direction)
    return Records(
        config=config,
        natural_period=natural_period,
        spectrum=spectrum(config.spectrum.kind, natural_period, config.spectrum.bandwidth),
        sensors=sensing.sensors(config.sensors),
        replicates=tuple(replicates),
        direction=np.array([np.cos(angle), np.sin(angle)]),
    )
