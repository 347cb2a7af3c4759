"""The record of a replay: a recording at the IMU's rate, from the first moment a fix is due.

Its measurements come replicate by replicate; sensors that were not recorded are simulated.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from owtsweep.arrays import Array
from owtsweep.process import give_back_freed_memory
from owtsweep.streams import Streams, stream
from owtsweep.studies.hub.public import ForceNoise, Sensors, fix_count, fix_noise, simulate_bias
from owtsweep.studies.replay.config import ReplayConfig

#: Steps beyond which a record is long: its memory is watched, and slow work is announced.
LONG = 1_000_000
STUDY = "replay"
#: Steps of specific force that are computed at once.
PIECE = 1 << 16


@dataclass(frozen=True, kw_only=True)
class ReplayRecord:
    """A record for a replay: series in SI units and NED coordinates, with one row per IMU step.

    gnss: where the fixes come from: "simulated", "recorded" or "from_reference".
    begin, step, steps: Time of step 0 on the file's clock (s), length of a step (s), number of
        steps.
    origin: Offset that has been subtracted from all positions, shape (2,) in m.
    position, velocity: the true ones (m, m/s), shape (steps, 2); NaN in gaps, None if unknown.
    acceleration: the true one (m/s^2), shape (steps, 2); None for recorded sensors.
    specific_force: as recorded (m/s^2) in the IMU's frame, shape (steps, 2); None for recorded
        motion.
    fixes: Fixes (m) as recorded, or made without noise, shape (fixes, 2); NaN where no fix came.
    truth: the source of the true position, in words; "" if the position is unknown.
    notes: What the user should know about the recording, one sentence each.
    lean: What a level IMU leaves out where a platform turns, one sentence; "" if nothing.
    """

    file: str
    gnss: str
    begin: float
    step: float
    steps: int
    origin: Array
    position: Array | None = None
    velocity: Array | None = None
    acceleration: Array | None = None
    specific_force: Array | None = None
    fixes: Array
    truth: str
    notes: tuple[str, ...]
    lean: str = ""

    @property
    def end(self) -> float:
        """The time of the last step on the file's clock, in s."""
        return self.begin + self.step * (self.steps - 1)

    def time_at(self, part: slice[int]) -> Array:
        """Return the times of the steps in a slice, on the file's clock, in s."""
        return np.asarray(self.begin + self.step * np.arange(*part.indices(self.steps)))

    def given(self, name: str) -> Array:
        """Return the series called `name`, e.g. "velocity"; raise TypeError if there is none."""
        series: Array | None = getattr(self, name)
        if series is None:
            raise TypeError(f"{self.file}: the record has no {name}")
        return series

    def release_memory(self) -> None:
        """Give some 100 MB of freed memory back, if the record has more than `LONG` steps."""
        if self.steps > LONG:
            give_back_freed_memory()


@dataclass(frozen=True)
class Signals:
    """The measurements of one replicate; the specific force comes in pieces, to save memory.

    steps: Number of IMU samples.
    fixes: in NED, shape (fixes, 2) in m; NaN where no fix came.
    force: yields the specific force in the IMU's frame from the record's start on, m/s^2, in pieces
        of shape (n, 2) of so many steps, by default `PIECE`; the last may be shorter.
    """

    steps: int
    fixes: Array
    force: Callable[..., Iterator[Array]]


def count_replicates(config: ReplayConfig, record: ReplayRecord) -> int:
    """Return the number of replicates of a record; 1 if nothing is simulated."""
    return 1 if record.gnss == "recorded" else config.replay.replicates


def listen(config: ReplayConfig, sensors: Sensors, record: ReplayRecord, replicate: int) -> Signals:
    """Return the measurements of one replicate; sensors that were not recorded are simulated.

    The simulated noise depends neither on the file nor on the length of the pieces.
    """
    steps, streams = record.steps, _streams_of(config, replicate)
    fixes = record.fixes
    if record.gnss != "recorded":
        fixes = fixes + fix_noise(config.sensors, sensors, steps, streams)

    def force(size: int = PIECE) -> Iterator[Array]:
        noise = ForceNoise(config.sensors, sensors, streams)
        for begin in range(0, steps, size):
            stop = begin + size
            if record.specific_force is not None:  # recorded data already contain noise
                yield record.specific_force[begin:stop]
                continue
            felt = record.given("acceleration")[begin:stop]
            if sensors.tilt != 0.0:
                felt = felt - sensors.lean * record.given("position")[begin:stop]
            part = felt @ sensors.rotation  # R' (a - g tilt d)
            part += noise.next(len(part))
            yield part

    return Signals(steps, fixes, force)


def make_fixes(position: Array, first: int, steps: int, sensors: Sensors) -> Array:
    """Make fixes without noise of positions (n, 2) at every IMU step, shape (fixes, 2), in m.

    The first arrives at the row `first`, at least `sensors.delay`, and tells of that delay before.
    """
    count = fix_count(steps, sensors.fix_interval)
    at = first - sensors.delay + sensors.fix_interval * np.arange(count)
    return np.array(position[at])


def cut_into_pieces(steps: int, size: int = PIECE) -> list[int]:
    """Return the steps at which pieces of `size` steps begin, and the number of steps."""
    return [*range(0, steps, size), steps]


def simulate_true_bias(
    config: ReplayConfig, sensors: Sensors, steps: int, replicate: int
) -> Iterator[Array]:
    """Yield the simulated bias R b^b of a replicate in NED, in pieces of shape (n, 2), m/s^2."""
    streams = _streams_of(config, replicate)
    return simulate_bias(config.sensors, sensors, steps, streams, piece=PIECE)


def _streams_of(config: ReplayConfig, replicate: int) -> Streams:
    return partial(stream, config.seed, STUDY, (0.0,), replicate)
