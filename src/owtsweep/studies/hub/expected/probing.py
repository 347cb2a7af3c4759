"""Running a chain on the sinusoids of a probe: energies of its errors over a record's windows."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.studies.hub import batch
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.expected.inputs import Probe
from owtsweep.studies.hub.kernels.layout import WIDTH as LANES
from owtsweep.studies.hub.kernels.layout import Output, new_registers
from owtsweep.studies.hub.sensors import fix_count
from owtsweep.studies.hub.settled import cycle_of, filling

T = TypeVar("T", bound=np.generic)

#: Lanes run at once, and the most numbers that their inputs may hold (128 MB).
WIDTH = 32
MOST_INPUTS = 16_000_000
#: Greatest relative change of a cycle's energy over `JUDGED` cycles that counts as none.
TOLERANCE = 1e-7
JUDGED = 32
#: Steps of input that are made in one go, and how far ahead of the chain.
BLOCK = 2048
AHEAD = 8192


def energies(chain: Chain, sensors: Sensors, probe: Probe, steps: int, settled: int) -> Array:
    """Sums of squared errors over the windows of a record, (measure, window, n).

    Measures are position and velocity, windows full and settled; for phasors cosine and sine count
    together.
    """
    lanes_each = 2 if probe.phasor else 1
    each = min(WIDTH // lanes_each, max(MOST_INPUTS // (steps * lanes_each), 1))
    parts = [
        _run(chain, sensors, probe.part(first, first + each), steps, settled)
        for first in range(0, len(probe.angle), each)
    ]
    return np.concatenate(parts, axis=-1)


def _run(chain: Chain, sensors: Sensors, probe: Probe, steps: int, settled: int) -> Array:
    """Phasors are run until their answer repeats; the rest of the record is more of the same."""
    from owtsweep.studies.hub.kernels import runs

    n, cycle = len(probe.angle), cycle_of(chain)
    lead = batch.lead_of(chain)
    waves = Waves(probe, steps, sensors, lead)
    groups = [_Group(chain, waves, number) for number in range(waves.groups)]
    chunk, memory = batch.chunk_of(chain)[0], batch.shared_memory([chain], 1)
    arrays = batch.arrays_of(chain)
    earliest = max(filling(chain), settled) + (JUDGED + 1) * cycle
    judged, rest = 0, 0.0
    ahead = max(AHEAD, 4 * (chain.filter.window + chain.predictor.steps))
    waves.make(ahead)
    for k0 in range(0, steps, chunk):
        count = min(chunk, steps - k0)
        end = k0 + count
        if end > waves.made:
            raise RuntimeError(f"a chunk of {count} steps has outrun the {ahead} steps made ahead")
        for group in groups:
            runs.estimates(
                k0, count, group.force, -lead, group.fixes, arrays, group.registers, *memory
            )
            group.add(k0, count, settled, cycle, memory[1])
        if probe.phasor and end >= earliest and end - judged >= JUDGED * cycle:
            judged = end
            ring = _joined([group.ring for group in groups], n)
            complete = np.delete(ring, (end // cycle) % len(ring), axis=0)
            if np.all(np.ptp(complete, axis=0) <= TOLERANCE * complete.max(axis=0)):
                rest = complete.mean(axis=0) * ((steps - end) / cycle)
                break
        waves.make(min(end + ahead, steps))
    sums = _joined([group.sums for group in groups], n)
    sums[1] += rest
    return np.stack([sums[0] + sums[1], sums[1]], axis=1)


def _joined(parts: list[Array], n: int) -> Array:
    """What groups hold, side by side, without the lanes that fill up the last one."""
    return np.concatenate(parts, axis=-1)[..., :n]


class _Group:
    """Eight lanes: what the chain carries for them, and the sums of their squared errors."""

    def __init__(self, chain: Chain, waves: Waves, number: int) -> None:
        self.probe = waves.probe
        self.force, self.fixes = (waves.force[number],), (waves.fixes[number],)
        self.registers = new_registers(1, chain.filter.window, chain.mhe.horizon)
        self.wave, self.rate = waves.wave[number], waves.rate[number]
        self.sums = np.zeros((2, 2, waves.each))  # part of the record, measure
        self.ring = np.zeros((JUDGED + 1, 2, waves.each))

    def add(self, k0: int, count: int, settled: int, cycle: int, output: Output) -> None:
        """Add the errors of the chunk that starts at step k0."""
        from owtsweep.studies.hub.expected.kernels import add_squares

        add_squares(
            k0, count, settled, cycle, output.position[0], output.velocity[0], self.wave, self.rate,
            self.probe.phasor, self.probe.truth, self.sums, self.ring,
        )  # fmt: skip


class Waves:
    """A probe's sinusoids in groups of eight lanes, made as they are needed.

    A group holds four cosines and their four sines, or eight sines; the last one is filled up with
    nothing. So the kernels read them where they are made.

    Attributes
    ----------
    force, fixes
        (groups, lead + steps, 8) and (groups, fixes, 8): the chain's inputs, from `lead` rows of
        zeros before step 0 on.
    wave
        (groups, steps, 8): the displacement, or nothing if there is no truth to follow.
    rate
        (groups, each): the sinusoids' angular frequencies, rad/s.
    made
        Steps that are filled.
    """

    def __init__(self, probe: Probe, steps: int, sensors: Sensors, lead: int) -> None:
        self.probe, self.steps, self.lead = probe, steps, lead
        self.each = LANES // 2 if probe.phasor else LANES
        self.groups = -(-len(probe.angle) // self.each)
        count = fix_count(steps, sensors.fix_interval)
        delay = sensors.delay if probe.truth else 0
        fix_steps = sensors.fix_interval * np.arange(count)[:, None] - delay
        fixes = np.exp(1j * (probe.angle * fix_steps + probe.shift)) * probe.fix
        parts = self._grouped(fixes).transpose(1, 0, 2)
        both = [parts.real, parts.imag] if probe.phasor else [parts.imag]
        self.fixes = np.ascontiguousarray(np.concatenate(both, axis=-1))
        self.force = np.zeros((self.groups, lead + steps, LANES))
        self.wave = np.empty((self.groups, steps if probe.truth else 0, LANES))
        self.rate = self._grouped(probe.angle / sensors.step)
        self.gain = self._grouped(probe.force)
        self.angle = self._grouped(probe.angle)
        self.turn = np.exp(1j * self.angle)
        self.made = 0 if np.any(probe.force) else steps

    def make(self, end: int) -> None:
        """Fill force and wave up to the step `end` at least."""
        from owtsweep.studies.hub.expected.kernels import make_waves

        probe, turn = self.probe, self.turn
        while self.made < min(end, self.steps):
            # anew in every block, so that rounding does not add up
            start = np.exp(1j * (self.angle * self.made + probe.shift))
            stop = min(self.made + BLOCK, self.steps)
            for g in range(self.groups):
                make_waves(
                    self.made, stop, start[g].real.copy(), start[g].imag.copy(),
                    turn[g].real.copy(), turn[g].imag.copy(), self.gain[g], probe.phasor,
                    probe.truth, self.force[g, self.lead :], self.wave[g],
                )  # fmt: skip
            self.made = stop

    def _grouped(self, values: NDArray[T]) -> NDArray[T]:
        """(..., n) as (..., groups, each), filled up with zeros."""
        room = self.groups * self.each - values.shape[-1]
        filled = np.pad(values, [(0, 0)] * (values.ndim - 1) + [(0, room)])
        return filled.reshape(*values.shape[:-1], self.groups, self.each)
