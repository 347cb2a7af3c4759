"""Runs a chain on the sinusoids of a probe and sums its squared errors in a record's windows.

A cosine or sine fills a lane; a sinusoid takes one lane or two. Kernels run sixteen lanes, a
pair's, at once.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array, aligned, make_mixed_rows, make_rows
from owtsweep.studies.hub import batch
from owtsweep.studies.hub.batch import new_memory
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.error_curves.inputs import Probe
from owtsweep.studies.hub.error_curves.layout import Buffers, Course, Waves
from owtsweep.studies.hub.kernels.layout import WIDTH as LANES
from owtsweep.studies.hub.kernels.layout import Memory
from owtsweep.studies.hub.sensors import Sensors, fix_count
from owtsweep.studies.hub.settled import cycle_of, filling

#: Greatest number of lanes that run together until the responses of all repeat. For long records
#: there are fewer lanes: lanes times steps is at most `MOST_INPUTS`.
WIDTH = 32
MOST_INPUTS = 16_000_000
#: A response repeats if a cycle's sum of squared errors changes by at most TOLERANCE, relatively,
#: in JUDGED cycles.
TOLERANCE = 1e-7
JUDGED = 32
#: Number of steps after which sinusoids start again, so that rounding errors do not accumulate.
BLOCK = 2048
#: The fields of `Buffers.errors` beside the wave.
ERRORS = ("p", "v", "pp", "vv")


class Workspace:
    """Runs one chain on probes as long as a record, one run at a time, in the same memory."""

    def __init__(self, chain: Chain, sensors: Sensors, steps: int, settled: int) -> None:
        self.chain, self.arrays, self.cycle = chain, batch.arrays_of(chain), cycle_of(chain)
        self.sensors, self.steps, self.settled = sensors, steps, settled
        self.chunk, self.lead = batch.chunk_of(chain)[0], batch.lead_of(chain)
        self.no_fixes = aligned(fix_count(steps, sensors.fix_interval), 2 * LANES)
        #: Of each pair: the memory of its scheme, and `Buffers.force` and `Buffers.wave`.
        self.pairs: list[tuple[Memory, Array, Array]] = []

    def pair(self, number: int) -> tuple[Memory, Array, Array]:
        """Return the item of `pairs` with this number, set to zero; the next one is made."""
        if number == len(self.pairs):
            count = self.lead + 2 * self.chunk
            memory = new_memory(self.arrays, 2 * LANES, self.chunk)
            self.pairs.append((memory, aligned(count, 2 * LANES), aligned(count, 4 * LANES)))
        memory, force, wave = self.pairs[number]
        for array in (*memory, force, wave):
            array.view(np.float64).fill(0.0)
        return memory, force, wave

    def energies(self, probe: Probe) -> Array:
        """Compute the sums of squared errors over a record for each of the probe's n sinusoids.

        The result has the shape (2, 2, n): measures position and velocity, windows full and
        settled. For a phasor, the sums of cosine and sine are added.
        """
        lanes_each = 2 if probe.phasor else 1
        each = min(WIDTH // lanes_each, max(MOST_INPUTS // (self.steps * lanes_each), 1))
        parts = [
            self._run(probe.part(first, first + each)) for first in range(0, len(probe.angle), each)
        ]
        return np.concatenate(parts, axis=-1)

    def _run(self, probe: Probe) -> Array:
        """Compute what `energies` returns, for a probe of at most `WIDTH` cosines and sines.

        Once the response has become periodic, its sums are extrapolated to the record's end.
        """
        each = LANES if probe.phasor else 2 * LANES
        pairs = [
            _Pair(self, number, probe.part(first, first + each))
            for number, first in enumerate(range(0, len(probe.angle), each))
        ]
        # step of the first test for repetition; none for single sines, whose sums oscillate
        earliest = max(filling(self.chain), self.settled) + (JUDGED + 1) * self.cycle
        done = _together(pairs, self.steps, earliest if probe.phasor else self.steps + 1)
        sums = _gather(pairs, "sums")
        if done < self.steps:
            ring = _gather(pairs, "ring")
            complete = np.delete(ring, (done // self.cycle) % len(ring), axis=0)
            sums[1] += complete.mean(axis=0) * ((self.steps - done) / self.cycle)
        return np.stack([sums[0] + sums[1], sums[1]], axis=1)


def _gather(pairs: list[_Pair], name: str) -> Array:
    """Return an array of all pairs' `Buffers`, by sinusoid on its last axis."""
    parts = [getattr(pair.buffers, name)[..., : pair.course.lanes] for pair in pairs]
    return np.concatenate(parts, axis=-1)


def _together(pairs: list[_Pair], steps: int, earliest: int) -> int:
    """Run pairs to the first step at which all responses repeat; return this step, or `steps`."""
    done = place = agreeing = 0
    while agreeing < len(pairs):
        pair = pairs[place]
        if pair.done < done:  # catch up with the others
            pair.advance(done, done)
        if pair.done < steps and not pair.repeats:
            pair.advance(steps, done + JUDGED * pair.cycle if done > 0 else earliest)
        if pair.done > done:
            done, agreeing = pair.done, 0
        agreeing += 1
        place = (place + 1) % len(pairs)
    return done


class _Pair:
    """Sixteen lanes: a scheme's state for the lanes, and sums of squared errors.

    The lanes hold the sinusoids of `probe`: up to eight cosines and their sines, or up to sixteen
    sines. Unused lanes are zero. `number` is that of the memory in `space`.
    """

    def __init__(self, space: Workspace, number: int, probe: Probe) -> None:
        self.space, self.cycle = space, space.cycle
        self.memory, force, wave = space.pair(number)
        self.waves = _waves(probe, space)
        self.course = Course(
            lead=space.lead, chunk=space.chunk, settled=space.settled, cycle=self.cycle,
            every=JUDGED * self.cycle, lanes=len(probe.angle), tolerance=TOLERANCE,
        )  # fmt: skip
        self.buffers = Buffers(
            filled=np.array([-space.lead, 0]),
            force=force,
            wave=wave,
            fixes=_fixes(probe, space) if np.any(probe.fix) else space.no_fixes,
            errors=make_mixed_rows([("wave", 4 * LANES), *((one, 2 * LANES) for one in ERRORS)], 1),
            sums=aligned(2, 2, 2 * LANES),
            ring=aligned(JUDGED + 1, 2, 2 * LANES),
        )
        self.done, self.repeats = 0, False

    def advance(self, stop: int, judged: int) -> None:
        """Run until the response repeats, tested from step `judged` on, or to step `stop`."""
        from owtsweep.studies.hub.error_curves.kernels import advance

        self.done, self.repeats = advance(
            self.done, stop, judged, self.course, self.waves, self.buffers, self.space.arrays,
            self.memory,
        )  # fmt: skip


def _waves(probe: Probe, space: Workspace) -> Waves:
    angle = _in_lanes(probe.angle, probe.phasor)
    # a quarter turn makes cosines of the sines in the first eight lanes
    quarter = np.repeat([0.5 * np.pi if probe.phasor else 0.0, 0.0], LANES)
    shift = np.broadcast_to(probe.shift, probe.angle.shape)
    shift = _in_lanes(shift, probe.phasor) + quarter
    blocks = -(-space.steps // BLOCK)
    start = np.exp(1j * (angle * (BLOCK * np.arange(blocks)[:, None]) + shift))
    now = make_rows(1, 2 * LANES, "c", "s", "turn_c", "turn_s", "force", "rate")
    turn = np.exp(1j * angle)
    now["turn_c"], now["turn_s"] = turn.real, turn.imag
    now["force"] = _in_lanes(probe.force, probe.phasor)
    now["rate"] = angle / space.sensors.step
    return Waves(
        starts=np.stack([start.real, start.imag], axis=1).reshape(-1, 2 * LANES),
        now=now,
        block=BLOCK,
        moving=bool(np.any(probe.force)),
        phasor=probe.phasor,
        truth=probe.truth,
    )


def _fixes(probe: Probe, space: Workspace) -> Array:
    """Make the position fixes (m) of a probe, shape (fixes, 16)."""
    delay = space.sensors.delay if probe.truth else 0
    fix_steps = space.sensors.fix_interval * np.arange(len(space.no_fixes))[:, None] - delay
    values = np.exp(1j * (probe.angle * fix_steps + probe.shift)) * probe.fix
    result = aligned(len(values), 2 * LANES)
    result[:] = _in_lanes(values.imag, probe.phasor)
    if probe.phasor:
        result[:, : values.shape[1]] = values.real
    return result


def _in_lanes(values: Array, phasor: bool) -> Array:
    """Arrange values (..., n), at most eight for phasors, in lanes (..., 16) padded with zeros."""
    missing = (1 if phasor else 2) * LANES - values.shape[-1]
    filled = np.pad(values, [(0, 0)] * (values.ndim - 1) + [(0, missing)])
    return np.concatenate([filled, filled], axis=-1) if phasor else filled
