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
    """Phasors are run until their answer repeats; the rest of the record is more of the same."""
    from owtsweep.studies.hub.expected.kernels import add_squares

    n, cycle = len(probe.angle), cycle_of(chain)
    waves = Waves(probe, steps, sensors)
    sums = np.zeros((2, 2, n))  # part of the record, measure
    ring = np.zeros((JUDGED + 1, 2, n))
    rate = probe.angle / sensors.step
    earliest = max(filling(chain), settled) + (JUDGED + 1) * cycle
    judged = 0
    ahead = max(AHEAD, 4 * (chain.filter.window + chain.predictor.steps))
    waves.make(ahead)
    for k0, count, memory in batch.chunks(chain, waves.force, waves.fixes):
        end = k0 + count
        if end > waves.made:
            raise RuntimeError(f"a chunk of {count} steps has outrun the {ahead} steps made ahead")
        add_squares(
            k0, count, settled, cycle, memory.position, memory.velocity, waves.wave, rate,
            probe.phasor, probe.truth, sums, ring,
        )  # fmt: skip
        if probe.phasor and end >= earliest and end - judged >= JUDGED * cycle:
            judged = end
            complete = np.delete(ring, (end // cycle) % len(ring), axis=0)
            if np.all(np.ptp(complete, axis=0) <= TOLERANCE * complete.max(axis=0)):
                sums[1] += complete.mean(axis=0) * ((steps - end) / cycle)
                break
        waves.make(min(end + ahead, steps))
    return np.stack([sums[0] + sums[1], sums[1]], axis=1)


class Waves:
    """A probe's sinusoids as lanes [cosines | sines], or sines alone, made as they are needed.

    Attributes
    ----------
    force, fixes
        (steps, lanes) and (fixes, lanes): the chain's inputs.
    wave
        (steps, lanes): the displacement, or nothing if there is no truth to follow.
    made
        Steps that are filled.
    """

    def __init__(self, probe: Probe, steps: int, sensors: Sensors) -> None:
        self.probe, self.steps = probe, steps
        count = fix_count(steps, sensors.fix_interval)
        delay = sensors.delay if probe.truth else 0
        fix_steps = sensors.fix_interval * np.arange(count)[:, None] - delay
        self.fixes = _lanes(
            np.exp(1j * (probe.angle * fix_steps + probe.shift)) * probe.fix, probe.phasor
        )
        shape = (steps, self.fixes.shape[1])
        self.force = np.zeros(shape)
        self.wave = np.empty(shape if probe.truth else (0, shape[1]))
        self.made = 0 if np.any(probe.force) else steps

    def make(self, end: int) -> None:
        """Fill force and wave up to the step `end` at least."""
        from owtsweep.studies.hub.expected.kernels import make_waves

        probe = self.probe
        turn = np.exp(1j * probe.angle)
        while self.made < min(end, self.steps):
            # anew in every block, so that rounding does not add up
            start = np.exp(1j * (probe.angle * self.made + probe.shift))
            stop = min(self.made + BLOCK, self.steps)
            make_waves(
                self.made, stop, start.real.copy(), start.imag.copy(), turn.real.copy(),
                turn.imag.copy(), probe.force, probe.phasor, probe.truth, self.force, self.wave,
            )  # fmt: skip
            self.made = stop


def _lanes(values: Complex, phasor: bool) -> Array:
    if not phasor:
        return np.ascontiguousarray(values.imag)
    return np.ascontiguousarray(np.hstack([values.real, values.imag]))
