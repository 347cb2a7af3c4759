"""Running a chain on the sinusoids of a probe: energies of its errors over a record's windows."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub import batch
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.expected.inputs import Complex, Probe
from owtsweep.studies.hub.sensors import fix_count
from owtsweep.studies.hub.settled import cycle_of, filling

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
    """Phasors are run until gains and answer repeat; the rest of the record is more of the same."""
    n, cycle = len(probe.angle), cycle_of(chain)
    waves = Waves(probe, steps, sensors)
    sums = np.zeros((2, 2, n))  # window part, measure
    cycles = Cycles(n, cycle)
    ahead = max(AHEAD, 4 * (chain.filter.window + chain.predictor.steps))
    waves.make(ahead)
    for k0, count, memory in batch.chunks(chain, waves.force, waves.fixes):
        end = k0 + count
        if end > waves.made:
            raise RuntimeError(f"a chunk of {count} steps has outrun the {ahead} steps made ahead")
        energy = np.empty((count, 2, n))
        for measure, source in enumerate((memory.position, memory.velocity)):
            error = source[:count]
            if probe.truth:
                error = error - waves.truth(k0, end, measure)
            square = error * error
            energy[:, measure] = square[:, :n] + square[:, n:] if probe.phasor else square
        split = min(max(settled - k0, 0), count)
        sums[0] += np.sum(energy[:split], axis=0)
        sums[1] += np.sum(energy[split:], axis=0)
        if probe.phasor and k0 >= max(filling(chain), settled):
            repeated = cycles.add(energy)
            if repeated is not None:
                sums[1] += repeated * ((steps - end) / cycle)
                break
        waves.make(min(end + ahead, steps))
    return np.stack([sums[0] + sums[1], sums[1]], axis=1)


class Cycles:
    """Energies of the last cycles, and whether they still change."""

    def __init__(self, sinusoids: int, cycle: int) -> None:
        self.kept = np.zeros((JUDGED * cycle, 2, sinusoids))
        self.filled = 0

    def add(self, energy: Array) -> Array | None:
        """Take energies by step; the energy of a cycle, (2, n), once it repeats, else None."""
        at, result = 0, None
        while at < len(energy):
            taken = min(len(self.kept) - self.filled, len(energy) - at)
            self.kept[self.filled : self.filled + taken] = energy[at : at + taken]
            self.filled, at = self.filled + taken, at + taken
            if self.filled == len(self.kept):
                self.filled = 0
                cycles = self.kept.reshape(JUDGED, -1, *self.kept.shape[1:]).sum(axis=1)
                if np.all(np.ptp(cycles, axis=0) <= TOLERANCE * cycles[-1]):
                    result = np.asarray(cycles.mean(axis=0))
        return result


class Waves:
    """A probe's sinusoids as lanes [cosines | sines], or sines alone, made as they are needed."""

    def __init__(self, probe: Probe, steps: int, sensors: Sensors) -> None:
        self.probe, self.steps, self.sensors = probe, steps, sensors
        count = fix_count(steps, sensors.fix_interval)
        delay = sensors.delay if probe.truth else 0
        fix_steps = sensors.fix_interval * np.arange(count)[:, None] - delay
        self.fixes = self._lanes(np.exp(1j * (probe.angle * fix_steps + probe.shift)) * probe.fix)
        shape = (steps, self.fixes.shape[1])
        self.force = np.zeros(shape)
        self.wave = np.empty(shape if probe.truth else (0, shape[1]))
        self.made = 0
        self._fine = np.exp(1j * probe.angle * np.arange(BLOCK)[:, None])

    def make(self, end: int) -> None:
        """Fill force and wave up to the step `end` at least."""
        probe = self.probe
        while self.made < min(end, self.steps):
            part = slice(self.made, min(self.made + BLOCK, self.steps))
            if np.any(probe.force):
                start = np.exp(1j * (probe.angle * self.made + probe.shift))
                values = start * self._fine[: part.stop - part.start]
                self.force[part] = self._lanes(values * probe.force)
                if probe.truth:
                    self.wave[part] = self._lanes(values)
            self.made = part.stop

    def truth(self, first: int, end: int, measure: int) -> Array:
        """Displacement (measure 0) or its rate (1) over some steps, (steps, lanes)."""
        wave = self.wave[first:end]
        if measure == 0:
            return wave
        rate = self.probe.angle / self.sensors.step
        cosine, sine = np.split(wave, 2, axis=1)
        return np.hstack([-rate * sine, rate * cosine])

    def _lanes(self, values: Complex) -> Array:
        if not self.probe.phasor:
            return np.ascontiguousarray(values.imag)
        return np.ascontiguousarray(np.hstack([values.real, values.imag]))
