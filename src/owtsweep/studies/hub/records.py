"""Makes records: motion and sensor noise under some conditions, for a few replicates.

In a given replicate of a given natural period, the phases of the motion and the noise are the same
for all schemes and amplitudes. With motion=plant, they are the same for all sea states and
structures.

Kernels take records by `Feed`: eight replicates side by side, span by span. Spans are made one
after the other in the same buffers, so only the motion is in memory for the whole record.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array, aligned
from owtsweep.motion.source import Motion, Source
from owtsweep.results.conditions import Value
from owtsweep.streams import Streams, stream
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.kernels.layout import WIDTH
from owtsweep.studies.hub.sensors import Measured, Sensors, fix_count
from owtsweep.studies.hub.worlds import find_world

STUDY = "hub"
#: Replicates of one block: 0-7, 8-15, ... They run side by side, in eight lanes.
REPLICATES_PER_BLOCK = 8
#: Most bytes of motion that a worker holds at a time. Eight records of up to 6600 s at 100 Hz fit.
MEMORY_SHARE = 128_000_000


@dataclass(frozen=True)
class Records:
    """The records of some replicates: motion of unit amplitude (or the plant's), and sensor noise.

    in_streams: values of the conditions that are in the keys of random streams.
    sensors: the sensors as they are; estimators may be told otherwise (`batch.know`).
    replicates: the numbers of the replicates, in order.
    direction: unit vector (2,) along the wave, north and east.
    """

    config: HubConfig
    in_streams: tuple[float, ...]
    source: Source
    sensors: Sensors
    replicates: tuple[int, ...]
    direction: Array

    @property
    def steps(self) -> int:
        return round(self.config.record.duration / self.sensors.step)

    def feed(self, amplitude: float | None = None) -> Iterator[Feed]:
        """Yield the kernels' input, of eight replicates after the other; see `Feed`."""
        for first in range(0, len(self.replicates), WIDTH):
            yield Feed(self, first, amplitude)

    @cached_property
    def motion(self) -> tuple[Motion, ...]:
        """The motions, one per replicate: of an amplitude of 1 m, or as the plant moves."""
        return tuple(self._realise(index) for index in range(len(self.replicates)))

    def _realise(self, index: int) -> Motion:
        motion = self.source.realise(
            self.stream(index), steps=self.steps, step=self.sensors.step, history=self.sensors.delay
        )
        leaning = sensing.lean(motion, self.config.sensors.imu.tilt)
        return sensing.couple(leaning, self.sensors)

    @cached_property
    def noise(self) -> tuple[Measured, ...]:
        """The noise of each replicate: all parts of the measurements that are not due to motion."""
        return tuple(
            Measured(self.force_noise(index).next(self.steps), self.fix_noise(index))
            for index in range(len(self.replicates))
        )

    def measure(self, amplitude: float) -> tuple[Array, Array]:
        """Return the measurements (motion plus noise) at an amplitude (m), in NED.

        They are the specific force, m/s^2, shape (steps, lanes), and the position fixes, m, shape
        (fixes, lanes). Lanes are x and y of the first replicate, x and y of the second, and so on.
        """
        motions, noises, s = self.motion, self.noise, self.sensors
        direction = np.tile(self.direction, len(motions))
        motion = np.stack([m.specific_force for m in motions], axis=1)
        count = len(noises[0].fixes)
        fixes = np.stack([m.position_at(-s.delay, s.fix_interval, count) for m in motions], axis=1)
        fixes = s.fix_scale * fixes
        noise_force = np.concatenate([n.specific_force @ s.rotation.T for n in noises], axis=1)
        noise_fixes = np.concatenate([n.fixes for n in noises], axis=1)
        return (
            amplitude * np.repeat(motion, 2, axis=1) * direction + noise_force,
            amplitude * np.repeat(fixes, 2, axis=1) * direction + noise_fixes,
        )

    def force_noise(self, index: int) -> sensing.ForceNoise:
        """Return a source that draws the noise of a replicate's specific force piece by piece."""
        return sensing.ForceNoise(self.config.sensors, self.sensors, self.stream(index))

    def fix_noise(self, index: int) -> Array:
        """Draw the noise of a replicate's fixes, m, shape (fixes, 2); NaN for a lost fix."""
        return sensing.fix_noise(self.config.sensors, self.sensors, self.steps, self.stream(index))

    def stream(self, index: int) -> Streams:
        """Return a function that takes a name, e.g. "gnss", and returns a random stream."""
        return partial(stream, self.config.seed, STUDY, self.in_streams, self.replicates[index])


def make_records(config: HubConfig, natural_period: float, replicates: Sequence[int]) -> Records:
    """Return the records of a spectrum at one natural period (s); see `make_records_at`."""
    return make_records_at(config, {"natural_period": natural_period}, replicates)


def make_records_at(
    config: HubConfig, conditions: Mapping[str, Value], replicates: Sequence[int]
) -> Records:
    """Return the records under all conditions but the amplitude, made at first use.

    `conditions` may have the amplitude too.
    """
    world, angle = find_world(config), np.deg2rad(config.wave_direction)
    source = world.make_source(config, conditions)
    return Records(
        config=config,
        in_streams=tuple(
            float(conditions[each.name]) for each in world.conditions if each.in_streams
        ),
        source=source,
        sensors=world.fit_sensors(source, sensing.sensors(config.sensors), config),
        replicates=tuple(replicates),
        direction=np.array([np.cos(angle), np.sin(angle)]),
    )


def count_records_per_block(config: HubConfig) -> int:
    """Return the most records of a block: fewer than `REPLICATES_PER_BLOCK` if they are long."""
    steps = config.record.duration * config.sensors.imu.rate
    fitting = MEMORY_SHARE // (find_world(config).bytes_per_step * steps)
    return int(min(max(fitting, 1), REPLICATES_PER_BLOCK))


#: Number of steps of a span: enough that Python's overhead is small, few enough for the last-level
#: cache.
SPAN = 10_000


class Span(NamedTuple):
    """A piece of the records of eight replicates, in the form that kernels take.

    stop: the number of the first step after the span.
    base: the number of the step in row 0, so step k is in row k - base. `base` may be negative;
        rows before step 0 are zero.
    force: specific force in NED, m/s^2, shape (rows, lanes): eight lanes each of motion, noise of x
        and noise of y, or of x and y of motion plus noise.
    motion: true displacement (m) and velocity (m/s) along the wave, for the motion of unit
        amplitude, eight columns each; shape (rows, 16).
    """

    stop: int
    base: int
    force: Array
    motion: Array


class Feed:
    """The kernels' input for up to eight replicates.

    Lanes of a kind stand side by side, eight each, one per replicate. Without an amplitude the
    kinds are motion, noise of x and noise of y; one lane of motion along the wave is enough,
    because x and y respond to motion alike. With an amplitude (m) they are x and y of motion plus
    noise.

    first: index of the first replicate in the records; up to seven more follow.
    fixes: positions that the GNSS reports, m, shape (fixes, lanes).
    """

    def __init__(self, records: Records, first: int = 0, amplitude: float | None = None) -> None:
        self.records = records
        self.indices = range(first, min(first + WIDTH, len(records.replicates)))
        self.amplitude = amplitude
        self.lanes = (3 if amplitude is None else 2) * WIDTH
        self.fixes = self._fixes()

    def _fixes(self) -> Array:
        sensors = self.records.sensors
        count = fix_count(self.records.steps, sensors.fix_interval)
        motion = np.zeros((count, WIDTH))
        noise = np.zeros((2, count, WIDTH))
        for lane, index in enumerate(self.indices):
            motion[:, lane] = sensors.fix_scale * self.records.motion[index].position_at(
                -sensors.delay, sensors.fix_interval, count
            )
            noise[:, :, lane] = self.records.fix_noise(index).T
        if self.amplitude is None:
            kinds = [motion, *noise]
        else:
            direction = self.records.direction[:, None, None]
            kinds = [*(self.amplitude * motion * direction + noise)]
        fixes = aligned(count, self.lanes)
        np.concatenate(kinds, axis=1, out=fixes)
        return fixes

    def spans(self, lead: int) -> Iterator[Span]:
        """Yield the spans of the records in order of time.

        Each span begins with the last `lead` rows of the one before. All spans use the same arrays,
        so a span is valid only until the next one is made.
        """
        from owtsweep.studies.hub.kernels import feeding

        steps = self.records.steps
        size = min(SPAN, steps)
        apart = aligned(lead + size, 3 * WIDTH)
        truth = aligned(lead + size, 2 * WIDTH)
        whole = apart if self.amplitude is None else aligned(lead + size, 2 * WIDTH)
        motion = [self.records.motion[index] for index in self.indices]
        draws = [self.records.force_noise(index).next for index in self.indices]
        to_ned = self.records.sensors.rotation.T
        for k0 in range(0, steps, SPAN):
            stop = min(k0 + SPAN, steps)
            if k0 > 0:
                for buffer in (whole, truth):
                    feeding.keep_rows(len(buffer) - lead, len(buffer), buffer)
            for rows, column, name in ((truth, 0, "position"), (truth, WIDTH, "velocity"),
                                       (apart, 0, "specific_force")):  # fmt: skip
                sources = np.array([getattr(series, name)[k0:stop] for series in motion])
                feeding.gather(lead, sources, rows, column)
            for lane, draw in enumerate(draws):
                apart[lead : lead + stop - k0, WIDTH + lane :: WIDTH] = draw(stop - k0) @ to_ned
            if self.amplitude is not None:
                direction = self.records.direction
                feeding.whole_series(stop - k0, lead, self.amplitude, direction, apart, whole)
            yield Span(stop, k0 - lead, whole, truth)
