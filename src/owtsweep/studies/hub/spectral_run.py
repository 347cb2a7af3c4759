"""Runs SKF on simulated records by compiled kernels, and sums its squared errors.

SKF has other gains along x than along y, and at each amplitude. So each axis of eight records runs
by itself, motion plus noise as one series.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from owtsweep.arrays import Array, aligned
from owtsweep.studies.hub.batch import Sums
from owtsweep.studies.hub.feed import Feed
from owtsweep.studies.hub.kernels.layout import WIDTH
from owtsweep.studies.hub.records import Records
from owtsweep.studies.hub.sensors import fix_count
from owtsweep.studies.hub.spectral_axis import TunedAxis

if TYPE_CHECKING:
    from owtsweep.studies.hub.kernels.spectral import SpectralArrays, SpectralMemory


class SpectralKernel(NamedTuple):
    """SKF in its form for the batch engine: its model and gains along x and along y."""

    axes: tuple[TunedAxis, TunedAxis]

    def sum_errors(
        self, records: Records, settled: int, amplitude: float, *, keep_squared: bool = False
    ) -> Sums:
        """Run all replicates of some records; sum the squared errors.

        Parameters
        ----------
        records
            The records, which are simulated during the run.
        settled
            Number of the first step after the settling time.
        amplitude
            Amplitude of the motion, m.
        keep_squared
            Whether the squared position error of each step is kept.
        """
        parts = [
            _run_eight(self.axes, part, first, amplitude, (settled, keep_squared))
            for part in records.parts()
            for first in range(0, len(part.replicates), WIDTH)
        ]
        sums, squared = (np.concatenate(arrays, axis=-1) for arrays in zip(*parts, strict=True))
        lengths = np.array([settled, records.steps - settled])
        interval = records.sensors.fix_interval
        early, whole = (fix_count(step, interval) for step in (settled, records.steps))
        return Sums(
            products=sums,
            steps=lengths,
            covariances=lengths,
            innovations=np.array([early, whole - early]),
            squared=squared,
        )

    def trajectories(self, force: Array, fixes: Array) -> tuple[Array, Array]:
        """Run one series of measurements; return the estimated positions (m) and velocities (m/s).

        Parameters
        ----------
        force, fixes
            Specific force, m/s^2, shape (steps, 2), and position fixes, m, shape (fixes, 2), in
            NED.

        Returns
        -------
        tuple of array
            Positions and velocities, shape (steps, 2) each.
        """
        from owtsweep.studies.hub.kernels.spectral import SpectralSpan, advance

        steps = len(force)
        result = np.empty((2, steps, 2))
        nothing = (aligned(steps, WIDTH),)
        for axis, tuned in enumerate(self.axes):
            series = [aligned(len(values), WIDTH) for values in (force, fixes)]
            for lanes, values in zip(series, (force, fixes), strict=True):
                lanes[:, 0] = values[:, axis]
            span = SpectralSpan(0, (series[0],), nothing, nothing, (series[1],), 0.0)
            memory = _new_memory(tuned, squared=aligned(0, WIDTH), shown=steps)
            advance(0, steps, 0, span, _arrays_of(tuned), memory)
            result[:, :, axis] = memory.estimates[0][:, 0].reshape(steps, 2).T
        return result[0], result[1]


def _run_eight(
    axes: tuple[TunedAxis, TunedAxis],
    records: Records,
    first: int,
    amplitude: float,
    what: tuple[int, bool],
) -> tuple[Array, Array]:
    """Run up to eight replicates from index `first` on; return their sums and squared errors.

    `what` is the number of the first settled step, and whether squared errors are kept. The sums
    have the shape (2, 6, 3, replicates) of `batch.Sums.products`.
    """
    from owtsweep.studies.hub.kernels.spectral import SpectralSpan, advance

    settled, keep = what
    feed = Feed(records, first, amplitude)
    arrays = [_arrays_of(tuned) for tuned in axes]
    squared = aligned(records.steps if keep else 0, WIDTH)
    memories = [_new_memory(tuned, squared=squared, shown=0) for tuned in axes]
    done = 0
    for span in feed.spans(1):
        for axis in range(2):
            fed = SpectralSpan(
                span.base,
                (span.force[axis],),
                (span.position,),
                (span.velocity,),
                (feed.fixes[axis],),
                float(amplitude * records.direction[axis]),
            )
            advance(done, span.stop, settled, fed, arrays[axis], memories[axis])
        done = span.stop
    count = len(feed.indices)
    # (axis, window, quantity, replicate)
    sums = np.stack([memory.sums[0].reshape(2, 4, WIDTH) for memory in memories])[..., :count]
    products = np.zeros((2, 6, 3, count))
    for axis in range(2):
        products[:, axis, 2] = sums[axis, :, 0]
        products[:, 2 + axis, 2] = sums[axis, :, 1]
    products[:, 4:, 2] = sums[0, :, 2:] + sums[1, :, 2:]
    return products, squared[:, :count]


def _arrays_of(tuned: TunedAxis) -> SpectralArrays:
    from owtsweep.studies.hub.kernels.spectral import SpectralArrays

    model, gains = tuned.axis.model, tuned.gains
    return SpectralArrays(
        A=model.A,
        fast=model.fast,
        position=tuned.axis.outputs[0].copy(),
        velocity=tuned.axis.outputs[1].copy(),
        copies=model.copies,
        interval=model.interval,
        delay=model.delay,
        fast_gain=gains.fast,
        slow_gain=gains.slow,
        precision=tuned.precision,
        weight=1.0 / gains.innovation_variance,
    )


def _new_memory(tuned: TunedAxis, *, squared: Array, shown: int) -> SpectralMemory:
    """Return the memory of a run along an axis, which shows the estimates of `shown` steps."""
    from owtsweep.studies.hub.kernels.spectral import SpectralMemory

    return SpectralMemory(
        state=(aligned(tuned.gains.fast.shape[1], WIDTH),),
        sums=(aligned(8, WIDTH),),
        squared=(squared,),
        estimates=(aligned(2 * shown, WIDTH),),
    )
