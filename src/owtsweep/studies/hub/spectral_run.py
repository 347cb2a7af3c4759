"""Runs SKF on simulated records by compiled kernels, and sums its squared errors.

SKF has other gains along x than along y, and at each amplitude. So motion plus
noise are run as one series.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from owtsweep.arrays import Array, aligned
from owtsweep.studies.hub.batch import Sums
from owtsweep.studies.hub.feed import Feed
from owtsweep.studies.hub.kernels.layout import WIDTH, Fed, Truth
from owtsweep.studies.hub.records import Records
from owtsweep.studies.hub.sensors import fix_count
from owtsweep.studies.hub.spectral_axis import TunedAxis

if TYPE_CHECKING:
    from owtsweep.studies.hub.kernels.spectral import SpectralArrays


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
        from owtsweep.studies.hub.kernels.spectral import advance, new_memory

        steps, arrays = len(force), _arrays_of(self.axes)
        series = [aligned(len(values), 2 * WIDTH) for values in (force, fixes)]
        for lanes, values in zip(series, (force, fixes), strict=True):
            lanes[:, ::WIDTH] = values
        shown = aligned(2, steps, 2 * WIDTH)
        memory = new_memory(arrays.fast_gain.shape[2], aligned(0, WIDTH), shown)
        truth = Truth(aligned(steps, 2 * WIDTH), np.zeros(2))
        advance(0, steps, 0, Fed(series[0], 0, series[1]), truth, arrays, memory)
        return shown[0, :, ::WIDTH].copy(), shown[1, :, ::WIDTH].copy()


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
    from owtsweep.studies.hub.kernels.spectral import advance, new_memory

    settled, keep = what
    feed, arrays = Feed(records, first, amplitude), _arrays_of(axes)
    squared = aligned(records.steps if keep else 0, WIDTH)
    nothing = aligned(2, 0, 2 * WIDTH)
    memory = new_memory(arrays.fast_gain.shape[2], squared, nothing)
    direction, done = amplitude * records.direction, 0
    for span in feed.spans(1):
        fed, truth = Fed(span.force, span.base, feed.fixes), Truth(span.motion, direction)
        advance(done, span.stop, settled, fed, truth, arrays, memory)
        done = span.stop
    count = len(feed.indices)
    # (window, axis, replicate)
    p, v, nees, nis = (
        memory.sums[name].reshape(2, 2, WIDTH)[..., :count] for name in ("pp", "vv", "nees", "nis")
    )
    products = np.zeros((2, 6, 3, count))
    products[:, :2, 2], products[:, 2:4, 2] = p, v
    products[:, 4, 2], products[:, 5, 2] = nees.sum(axis=1), nis.sum(axis=1)
    return products, squared[:, :count]


def _arrays_of(axes: tuple[TunedAxis, TunedAxis]) -> SpectralArrays:
    """Join the arrays of both axes; the gains that settle first are repeated to the same length."""
    from owtsweep.studies.hub.kernels.spectral import SpectralArrays

    model = axes[0].axis.model
    count = max(len(tuned.gains.fast) for tuned in axes)

    def long(values: Sequence[Array], cycle: int, count: int) -> Array:
        """Join one array of each axis, (rows, ...), to (2, count, ...); the last rows repeat."""
        settled = [len(one) - cycle for one in values]
        k = np.arange(count)
        return np.stack(
            [
                one[np.where(k < rest, k, rest + (k - rest) % cycle)]
                for one, rest in zip(values, settled, strict=True)
            ]
        )

    gains, fixes = [tuned.gains for tuned in axes], count // model.interval
    return SpectralArrays(
        A=np.stack([tuned.axis.model.A for tuned in axes]),
        fast=np.stack([tuned.axis.model.fast for tuned in axes]),
        position=np.stack([tuned.axis.outputs[0] for tuned in axes]),
        velocity=np.stack([tuned.axis.outputs[1] for tuned in axes]),
        copies=model.copies,
        interval=model.interval,
        delay=model.delay,
        fast_gain=long([one.fast for one in gains], model.interval, count),
        slow_gain=long([one.slow for one in gains], 1, fixes),
        precision=long([tuned.precision for tuned in axes], model.interval, count),
        weight=long([1.0 / one.innovation_variance for one in gains], 1, fixes),
    )
