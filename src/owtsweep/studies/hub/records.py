"""The records of one block: motion and noise of one period and a few replicates.

All schemes and amplitudes of a (period, replicate) see the same phases and the same noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.spectra import spectrum
from owtsweep.motion.synthesis import Motion, synthesise
from owtsweep.streams import stream
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Sensors

STUDY = "hub"


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
    noise
        One per replicate: everything in the measurements that is not motion.
    """

    sensors: Sensors
    replicates: tuple[int, ...]
    direction: Array
    motion: tuple[Motion, ...]
    noise: tuple[sensing.Measurements, ...]

    @property
    def steps(self) -> int:
        """IMU steps of a record."""
        return len(self.motion[0].position)


def make_records(config: HubConfig, natural_period: float, replicates: Sequence[int]) -> Records:
    """Draw the records of one period and some replicates."""
    known = sensing.sensors(config.sensors)
    steps = round(config.record.duration / known.step)
    shape = spectrum(config.spectrum.kind, natural_period, config.spectrum.bandwidth)
    angle = np.deg2rad(config.wave_direction)
    motions, noises = [], []
    for replicate in replicates:

        def named(name: str, replicate: int = replicate) -> np.random.Generator:
            return stream(config.seed, STUDY, natural_period, replicate, name)

        motions.append(
            synthesise(
                shape,
                named("phase"),
                steps=steps,
                step=known.step,
                band=(config.band[0], config.band[1]),
                normalise=config.normalise,
                history=known.delay,
            )
        )
        noises.append(sensing.noise(config.sensors, known, steps, named))
    return Records(
        sensors=known,
        replicates=tuple(replicates),
        direction=np.array([np.cos(angle), np.sin(angle)]),
        motion=tuple(motions),
        noise=tuple(noises),
    )
