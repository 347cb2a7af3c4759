"""Makes records: motion and sensor noise under some conditions, for a few replicates.

In a given replicate of a given natural period, the phases of the motion and the noise are the same
for all schemes and amplitudes. With motion=plant, they are the same for all sea states and
structures.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.source import Motion, Source
from owtsweep.results.conditions import Value
from owtsweep.streams import stream
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.conditions import find_world
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.sensors import Measured, Sensors

STUDY = "hub"
#: Replicates of one block: 0-7, 8-15, ... They run side by side, in eight lanes.
REPLICATES_PER_BLOCK = 8
#: Most bytes of motion that a worker holds at a time. Eight records of up to 6600 s at 100 Hz fit.
MEMORY_SHARE = 128_000_000


@dataclass(frozen=True)
class Records:
    """The records of some replicates: motion of unit amplitude (or the plant's), and sensor noise.

    conditions: the conditions of the motion, without the amplitude.
    in_streams: values of those conditions that are in the keys of random streams.
    sensors: what estimators may know about the sensors.
    replicates: the numbers of the replicates, in order.
    direction: unit vector (2,) along the wave, north and east.
    """

    config: HubConfig
    conditions: Mapping[str, Value]
    in_streams: tuple[float, ...]
    source: Source
    sensors: Sensors
    replicates: tuple[int, ...]
    direction: Array

    @property
    def steps(self) -> int:
        return round(self.config.record.duration / self.sensors.step)

    def parts(self) -> Iterator[Records]:
        """Yield records of fewer replicates, so that their motion fits into `MEMORY_SHARE` bytes.

        They hold all replicates, in order. Each makes its motion at first use; deleting it frees
        the memory. If all replicates fit at once, yield `self`.
        """
        count = len(self.replicates)
        each_step = find_world(self.config).bytes_per_step
        each = max(MEMORY_SHARE // (each_step * self.steps), 1)
        if each >= count:
            yield self
            return
        for first in range(0, count, each):
            yield replace(self, replicates=self.replicates[first : first + each])

    @cached_property
    def motion(self) -> tuple[Motion, ...]:
        """The motions, one per replicate: of an amplitude of 1 m, or as the plant moves."""
        return tuple(self._realise(index) for index in range(len(self.replicates)))

    def _realise(self, index: int) -> Motion:
        motion = self.source.realise(
            self.stream(index),
            steps=self.steps,
            step=self.sensors.step,
            history=self.sensors.delay,
        )
        leaning = find_world(self.config).lean(motion, self.sensors, self.config)
        return sensing.couple(leaning, self.sensors)

    @cached_property
    def noise(self) -> tuple[Measured, ...]:
        """The noise of each replicate: all parts of the measurements that are not due to motion."""
        return tuple(
            sensing.noise(self.config.sensors, self.sensors, self.steps, self.stream(index))
            for index in range(len(self.replicates))
        )

    @property
    def keeps_noise(self) -> bool:
        """Whether the property `noise` has been used, so that the noise is kept in memory."""
        return "noise" in vars(self)

    def force_noise(self, index: int) -> sensing.ForceNoise:
        """Return a source that draws the noise of a replicate's specific force piece by piece."""
        return sensing.ForceNoise(self.config.sensors, self.sensors, self.stream(index))

    def fix_noise(self, index: int) -> Array:
        """Draw the noise of a replicate's fixes, m, shape (fixes, 2); NaN for a lost fix."""
        return sensing.fix_noise(self.config.sensors, self.sensors, self.steps, self.stream(index))

    def stream(self, index: int) -> Callable[[str], np.random.Generator]:
        """Return a function that takes a name, e.g. "gnss", and returns a random stream."""
        return partial(stream, self.config.seed, STUDY, self.in_streams, self.replicates[index])


def make_records(config: HubConfig, natural_period: float, replicates: Sequence[int]) -> Records:
    """Return the records of a spectrum at one natural period (s); see `make_records_at`."""
    return make_records_at(config, {"natural_period": natural_period}, replicates)


def make_records_at(
    config: HubConfig, conditions: Mapping[str, Value], replicates: Sequence[int]
) -> Records:
    """Return the records under all conditions but the amplitude, made at first use.

    With motion=plant and sensors.imu.tilt=structure, the tilt that estimators may know is the slope
    of the first mode, rad/m.
    """
    world = find_world(config)
    source = world.make_source(config, conditions)
    return Records(
        config=config,
        conditions=dict(conditions),
        in_streams=tuple(
            float(conditions[each.name]) for each in world.conditions if each.in_streams
        ),
        source=source,
        sensors=world.fit_sensors(source, sensing.sensors(config.sensors), config),
        replicates=tuple(replicates),
        direction=_direction(config),
    )


def _direction(config: HubConfig) -> Array:
    angle = np.deg2rad(config.wave_direction)
    return np.array([np.cos(angle), np.sin(angle)])


def count_records_per_block(config: HubConfig) -> int:
    """Return the most records of a block: fewer than `REPLICATES_PER_BLOCK` if they are long."""
    steps = config.record.duration * config.sensors.imu.rate
    fitting = MEMORY_SHARE // (find_world(config).bytes_per_step * steps)
    return int(min(max(fitting, 1), REPLICATES_PER_BLOCK))
