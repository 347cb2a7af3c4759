"""The records of one block: motion and noise of one period and a few replicates.

All schemes and amplitudes of a (period, replicate) see the same phases and the same noise.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from owtsweep import paging
from owtsweep.arrays import Array
from owtsweep.motion.source import Motion
from owtsweep.motion.spectra import spectrum
from owtsweep.motion.synthesis import synthesise
from owtsweep.streams import stream
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Sensors

STUDY = "hub"
#: Numbers of a block's motion that are kept in memory (40 MB); more of them lie in a file. Eight
#: records of the default length stay just below, which is faster.
MOST_IN_MEMORY = 5_000_000


@dataclass(frozen=True)
class Records:
    """Unit-amplitude motions and noises of some replicates.

    Attributes
    ----------
    replicates
        Their numbers, in order.
    direction
        (2,): the wave's direction in NED.
    motion
        One per replicate, scaled to the unit amplitude.
    """

    config: HubConfig
    natural_period: float
    sensors: Sensors
    replicates: tuple[int, ...]
    direction: Array
    motion: tuple[Motion, ...]

    @cached_property
    def noise(self) -> tuple[sensing.Measurements, ...]:
        """One per replicate: everything in the measurements that is not motion, whole and kept."""
        return tuple(
            sensing.noise(self.config.sensors, self.sensors, self.steps, self.stream(index))
            for index in range(len(self.replicates))
        )

    @property
    def keeps_noise(self) -> bool:
        """Whether somebody has asked for the whole noise."""
        return "noise" in vars(self)

    def force_noise(self, index: int) -> sensing.ForceNoise:
        """The noise of the specific force of the replicate with this index, piece by piece."""
        return sensing.ForceNoise(self.config.sensors, self.sensors, self.stream(index))

    def fix_noise(self, index: int) -> Array:
        """(fixes, 2) noise of the fixes of the replicate with this index, m."""
        return sensing.fix_noise(self.sensors, self.steps, self.stream(index))

    def stream(self, index: int) -> Callable[[str], np.random.Generator]:
        """The named streams of the replicate with this index."""
        return partial(
            stream, self.config.seed, STUDY, (self.natural_period,), self.replicates[index]
        )

    @property
    def steps(self) -> int:
        """IMU steps of a record."""
        return len(self.motion[0].position)


def make_records(config: HubConfig, natural_period: float, replicates: Sequence[int]) -> Records:
    """The records of one period and some replicates: motion now, noise when it is needed."""
    known = sensing.sensors(config.sensors)
    steps = round(config.record.duration / known.step)
    shape = spectrum(config.spectrum.kind, natural_period, config.spectrum.bandwidth)
    angle = np.deg2rad(config.wave_direction)
    size = (len(replicates), 3, steps)
    count = int(np.prod(size))
    # small pieces in memory are used again by the next block; one large one is made anew
    kept = (
        paging.room(count, again=True).reshape(size)
        if count > MOST_IN_MEMORY
        else [None] * len(replicates)
    )
    motions = [
        synthesise(
            shape,
            stream(config.seed, STUDY, (natural_period,), replicate, "phase"),
            steps=steps,
            step=known.step,
            band=(config.band[0], config.band[1]),
            normalise=config.normalise,
            history=known.delay,
            out=out,
        )
        for replicate, out in zip(replicates, kept, strict=True)
    ]
    return Records(
        config=config,
        natural_period=natural_period,
        sensors=known,
        replicates=tuple(replicates),
        direction=np.array([np.cos(angle), np.sin(angle)]),
        motion=tuple(motions),
    )
