"""Makes the kernels' input: the records of eight replicates, span by span.

A span has 10 000 steps: specific force and true motion in rows of eight lanes, one per replicate.
Spans are made one after the other in the same buffers, so only the motion is in memory for the
whole record.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cached_property
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array, aligned
from owtsweep.studies.hub.kernels.layout import WIDTH
from owtsweep.studies.hub.records import Records
from owtsweep.studies.hub.sensors import fix_count

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


class Lanes:
    """The records of some replicates, whose motion and noise stay in memory for repeated runs."""

    def __init__(self, records: Records) -> None:
        self.records = records
        _ = records.noise  # makes the noise, which is then kept

    @cached_property
    def position(self) -> Array:
        """The true displacement along the wave at unit amplitude, m, shape (steps, replicates)."""
        return np.stack([motion.position for motion in self.records.motion], axis=1)

    @cached_property
    def velocity(self) -> Array:
        """The true velocity along the wave at unit amplitude, m/s, shape (steps, replicates)."""
        return np.stack([motion.velocity for motion in self.records.motion], axis=1)

    def at(self, amplitude: float) -> tuple[Array, Array]:
        """Return the measurements (motion plus noise) at an amplitude (m), in NED.

        They are the specific force, m/s^2, shape (steps, lanes), and the position fixes, m, shape
        (fixes, lanes). Lanes are x and y of the first replicate, x and y of the second, and so on.
        """
        motions, noises, s = self.records.motion, self.records.noise, self.records.sensors
        direction = np.tile(self.records.direction, len(motions))
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
        fill = self._noise(size)
        for k0 in range(0, steps, SPAN):
            stop = min(k0 + SPAN, steps)
            if k0 > 0:
                for buffer in (whole, truth):
                    feeding.keep_rows(len(buffer) - lead, len(buffer), buffer)
            for rows, column, name in ((truth, 0, "position"), (truth, WIDTH, "velocity"),
                                       (apart, 0, "specific_force")):  # fmt: skip
                sources = tuple(getattr(series, name) for series in motion)
                feeding.gather(k0, stop - k0, lead, sources, rows, column)
            fill(stop - k0, lead, apart)
            if self.amplitude is not None:
                direction = self.records.direction
                feeding.whole_series(stop - k0, lead, self.amplitude, direction, apart, whole)
            yield Span(stop, k0 - lead, whole, truth)

    def _noise(self, size: int) -> Callable[[int, int, Array], None]:
        """Return a function that writes the next steps of the noise of the specific force, in NED.

        It takes the number of steps (at most `size`), the first row to write, and the array to
        write to, shape (rows, 24), whose second eight columns are of x, and the third of y.
        """
        from owtsweep.studies.hub.kernels import feeding

        records, R = self.records, self.records.sensors.rotation
        if records.keeps_noise or not np.array_equal(R, np.eye(2)):
            draws = [self._force_noise(index) for index in self.indices]

            def turned(steps: int, lead: int, force: Array) -> None:
                for lane, draw in enumerate(draws):
                    force[lead : lead + steps, WIDTH + lane :: WIDTH] = draw(steps) @ R.T

            return turned
        sources = [records.force_noise(index) for index in self.indices]
        bias_x, white_x = sources[0].bias[0], sources[0].white[0]
        imu = (bias_x.deviation, bias_x.initial, white_x.sigma, sources[0].gravity)
        normals, bias = np.empty((len(sources), 4, size)), np.zeros((len(sources), 2))
        begun = False

        def straight(steps: int, lead: int, force: Array) -> None:
            nonlocal begun
            for source, drawn in zip(sources, normals, strict=True):
                source.draw(drawn[:, :steps])
            feeding.noise(steps, lead, normals, begun, bias, imu, force)
            begun = True

        return straight

    def _force_noise(self, index: int) -> Callable[[int], Array]:
        """Return a function of a number of steps that returns the noise of these next steps.

        The noise is that of one replicate's specific force in the IMU's frame, m/s^2, shape
        (steps, 2); from memory if the records keep it, otherwise drawn.
        """
        if not self.records.keeps_noise:
            return self.records.force_noise(index).next
        kept, position = self.records.noise[index].specific_force, 0

        def following(steps: int) -> Array:
            nonlocal position
            position += steps
            return kept[position - steps : position]

        return following
