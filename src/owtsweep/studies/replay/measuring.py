"""What the sensors report of a record: recorded as it is, or simulated in a replicate."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from owtsweep.arrays import Array
from owtsweep.streams import stream
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.sensors import ForceNoise, Measurements
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.record import Record

STUDY = "replay"
#: Steps of specific force that are made at once; of a shorter record all.
PIECE = 1 << 16


@dataclass(frozen=True)
class Signals:
    """The measurements of a replicate; the specific force comes in pieces.

    Attributes
    ----------
    steps
        How many samples of the IMU.
    fixes
        (fixes, 2) in NED, m; NaN where none came.
    force
        Length of a piece -> (steps, 2) in the IMU's frame, m/s^2, piece by piece; from the start
        each time it is called.
    """

    steps: int
    fixes: Array
    force: Callable[[int], Iterator[Array]]

    def whole(self) -> Measurements:
        """All at once."""
        return Measurements(next(self.force(self.steps)), self.fixes)


def replicates(config: ReplayConfig, record: Record) -> int:
    """How many replicates a record has: one where nothing is simulated."""
    return 1 if record.gnss == "recorded" else config.replay.replicates


def listen(config: ReplayConfig, sensors: Sensors, record: Record, replicate: int) -> Signals:
    """The measurements of one replicate, made as they are taken.

    All records see the same draws of a replicate, whatever file they come from and whatever pieces
    they are taken in.
    """
    steps, named = record.steps, _streams(config, replicate)
    fixes = record.fixes
    if record.gnss != "recorded":
        fixes = fixes + sensing.fix_noise(sensors, steps, named)
    if record.specific_force is not None:  # no noise is added to what a real IMU said
        return Signals(steps, fixes, cut(record.specific_force))
    acceleration = record.given("acceleration")

    def force(size: int) -> Iterator[Array]:
        noise = ForceNoise(config.sensors, sensors, named)
        for begin in range(0, steps, size):
            part = acceleration[begin : begin + size] @ sensors.rotation  # R' a
            part += noise.next(len(part))
            yield part

    return Signals(steps, fixes, force)


def pieces_of(steps: int, size: int = PIECE) -> list[int]:
    """Where the pieces of a record begin, and where the last one ends."""
    return [*range(0, steps, size), steps]


def cut(series: Array) -> Callable[[int], Iterator[Array]]:
    """A series that is there, handed out in pieces."""
    return lambda size: (series[at : at + size] for at in range(0, len(series), size))


def given(measured: Measurements) -> Signals:
    """Measurements that are there, as signals."""
    force = measured.specific_force
    return Signals(len(force), measured.fixes, cut(force))


def measure(config: ReplayConfig, sensors: Sensors, record: Record, replicate: int) -> Measurements:
    """The measurements of one replicate; fixes are NaN where none came."""
    return listen(config, sensors, record, replicate).whole()


def simulated_bias(
    config: ReplayConfig, sensors: Sensors, steps: int, replicate: int
) -> Iterator[Array]:
    """R b^b of a replicate of a motion, (steps, 2) m/s^2, in pieces: its noise without all else."""
    quiet = replace(sensors, force_sigma=0.0, gravity=(0.0, 0.0))
    noise = ForceNoise(config.sensors, quiet, _streams(config, replicate))
    for begin in range(0, steps, PIECE):
        yield np.asarray(noise.next(min(PIECE, steps - begin)) @ sensors.rotation.T)


def _streams(config: ReplayConfig, replicate: int) -> Callable[[str], np.random.Generator]:
    return partial(stream, config.seed, STUDY, (0.0,), replicate)
