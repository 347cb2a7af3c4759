"""Runs SKF on simulated records by compiled kernels, and sums its squared errors.

SKF has other gains along x than along y, and at each amplitude. So each axis is run by itself, and
motion plus noise are run as one series.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array, aligned
from owtsweep.estimation.late import follow, prepare_estimates, start_lanes
from owtsweep.studies.hub.kernels.layout import WIDTH
from owtsweep.studies.hub.kernels.sums import add_spectral_errors
from owtsweep.studies.hub.measures import Sums, join_sums
from owtsweep.studies.hub.records import Feed, Records
from owtsweep.studies.hub.sensors import fix_count
from owtsweep.studies.hub.spectral_model import LONGEST_TRANSIENT, SpectralAxis


class SpectralKernel(NamedTuple):
    """SKF in its form for the batch engine: its models along x and along y."""

    axes: tuple[SpectralAxis, SpectralAxis]

    def sum_errors(
        self, records: Records, settled: int, amplitude: float, *, keep_squared: bool = False
    ) -> Sums:
        parts = [self._run_eight(feed, settled, keep_squared) for feed in records.feed(amplitude)]
        interval = records.sensors.fix_interval
        return join_sums(parts, settled, records.steps, lambda step: fix_count(step, interval))

    def _run_eight(self, feed: Feed, settled: int, keep: bool) -> tuple[Array, Array]:
        """Run up to eight replicates; return sums (2, 6, 3, replicates) and squared errors."""
        records = feed.records
        assert feed.amplitude is not None
        direction, count, done = feed.amplitude * records.direction, len(feed.indices), 0
        squared = np.zeros((records.steps if keep else 0, WIDTH))
        runs = [AxisRun(axis, number, feed) for number, axis in enumerate(self.axes)]
        for span in feed.spans(1):
            part = slice(done - span.base, span.stop - span.base)
            for run, cosine in zip(runs, direction, strict=True):
                run.advance(
                    done, span.force[part], span.motion[part], cosine, settled, squared[done:]
                )
            done = span.stop
        p, v, nees = (np.stack([run.sums[:, i] for run in runs], axis=1) for i in range(3))
        products = np.zeros((2, 6, 3, WIDTH))
        products[:, :2, 2], products[:, 2:4, 2], products[:, 4, 2] = p, v, nees.sum(axis=1)
        products[:, 5, 2] = sum(run.nis for run in runs)
        return products[..., :count], squared[:, :count]


class AxisRun:
    """The filter along x (0) or y (1) on eight records, whose measurements arrive span by span."""

    def __init__(self, axis: SpectralAxis, number: int, feed: Feed) -> None:
        self.axis, self.column, self.fixes = axis, WIDTH * number, feed.fixes
        self.rows = axis.gains.find(min(feed.records.steps, LONGEST_TRANSIENT))
        self.state = start_lanes(len(axis.first), WIDTH)
        #: Before and after settling; squared errors of position and velocity, NEES; replicates.
        self.sums = aligned(2, 3, WIDTH)
        self.nis = np.zeros((2, WIDTH))

    def advance(
        self, first: int, force: Array, motion: Array, cosine: float, settled: int, squared: Array
    ) -> None:
        """Run the filter from step `first` on, and add its squared errors to the sums.

        `cosine` times the motion, shape (steps, 16), is the truth along the axis. The squared
        position errors are added to `squared`, one row per step, unless it is empty.
        """
        steps, M = len(force), self.axis.model.interval
        fix, stop = (fix_count(step, M) for step in (first, first + steps))
        found = prepare_estimates(steps, stop - fix, WIDTH)
        follow(
            first, force, self.fixes[fix:stop], self.column, self.axis.model, self.axis.outputs,
            self.rows, self.state, found,
        )  # fmt: skip
        add_spectral_errors(settled - first, found, motion, cosine, self.sums, squared)
        scores, early = found.innovation**2 / found.variance[:, None], fix_count(settled, M) - fix
        self.nis[0] += scores[: max(early, 0)].sum(axis=0)
        self.nis[1] += scores[max(early, 0) :].sum(axis=0)
