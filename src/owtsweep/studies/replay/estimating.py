"""Run one scheme on a record, piece by piece: estimates, covariances, innovations."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.loop import Updating, run_steps
from owtsweep.evaluation.trajectory import Trajectory, spread_to_both_axes
from owtsweep.studies.hub.public import (
    Chain,
    HubConfig,
    Known,
    OnePassSeries,
    Scheme,
    Sensors,
    chunks,
)
from owtsweep.studies.replay.record import PIECE, Signals


def estimate_pieces(
    config: HubConfig,
    scheme: Scheme,
    sensors: Sensors,
    replicates: Sequence[Signals],
    edges: Sequence[int],
) -> Iterator[tuple[Trajectory, ...]]:
    """Run a scheme on some replicates of a record; yield a `Trajectory` of each, piece by piece.

    If every fix arrived, the batch engine runs all replicates at once. If fixes are missing, gains
    depend on which these are: the scheme's online form (`stream`) computes them step by step. With
    engine=reference, or without kernel and online form, `update` is called at every step. Estimates
    depend neither on the pieces nor on the number of replicates.

    edges: the steps at which the pieces begin, and the number of steps.
    Raises ValueError if an estimate lacks a quantity, has the wrong shape or is not finite.
    """
    known, start = Known(sensors, config), scheme.start
    if config.engine == "batch":
        complete = all(bool(np.all(np.isfinite(signals.fixes))) for signals in replicates)
        if complete and scheme.batched == "chain":
            chain = scheme.kernel_for_runs(known, replicates[0].steps)
            return _run_kernel(chain, sensors, replicates, edges)
        start = scheme.stream
    runs = [_run_estimator(start(known), sensors, signals, edges) for signals in replicates]
    return zip(*runs, strict=True)


def rotate_force(signals: Signals, sensors: Sensors) -> Iterator[Array]:
    """Yield the measured specific force in NED coordinates, in m/s^2, in pieces of shape (n, 2)."""
    return (piece @ sensors.rotation.T for piece in signals.force(PIECE))


def make_lanes(replicates: Sequence[Signals], sensors: Sensors) -> tuple[OnePassSeries, Array]:
    """Arrange the measurements of replicates side by side, for the batch engine.

    Returns the specific force in NED (m/s^2, one row per step) and the fixes (m, one row each),
        with the columns x and y of the first replicate, then of the second, and so on.
    """
    pieces = zip(*(rotate_force(signals, sensors) for signals in replicates), strict=True)
    side_by_side = (np.concatenate(parts, axis=1) for parts in pieces)
    fixes = np.concatenate([signals.fixes for signals in replicates], axis=1)
    return OnePassSeries(side_by_side, (replicates[0].steps, 2 * len(replicates))), fixes


def _run_kernel(
    chain: Chain, sensors: Sensors, replicates: Sequence[Signals], edges: Sequence[int]
) -> Iterator[tuple[Trajectory, ...]]:
    estimates = chunks(chain, *make_lanes(replicates, sensors))
    covariances = spread_to_both_axes(chain.covariance)
    first, count, chunk = next(estimates)
    for begin, end in itertools.pairwise(edges):
        state = np.empty((len(replicates), end - begin, 4))
        innovation = np.empty((len(replicates), end - begin, 2))
        at = begin
        while at < end:
            if at == first + count:
                first, count, chunk = next(estimates)
            stop = min(first + count, end)
            source, target = slice(at - first, stop - first), slice(at - begin, stop - begin)
            for replicate in range(len(replicates)):
                lanes = slice(2 * replicate, 2 * replicate + 2)
                state[replicate, target, :2] = chunk.position[source, lanes]
                state[replicate, target, 2:] = chunk.velocity[source, lanes]
                innovation[replicate, target] = chunk.innovation[source, lanes]
            at = stop
        row = chain.gains.row(np.arange(begin, end))
        fresh = chain.gains.fresh[row]
        innovation[:, ~fresh] = np.nan
        variance = np.where(fresh, chain.gains.innovation_variance[row], np.nan)
        covariance = covariances[row]
        innovation_covariance = variance[:, None, None] * np.eye(2)
        piece = [
            Trajectory(state[i], covariance, innovation[i], innovation_covariance)
            for i in range(len(replicates))
        ]
        # Free this piece of a long record before the next one is made.
        del state, innovation, covariance, innovation_covariance, variance, row
        yield tuple(piece.pop(0) for _ in replicates)


def _run_estimator(
    estimator: Updating, sensors: Sensors, signals: Signals, edges: Sequence[int]
) -> Iterator[Trajectory]:
    force = OnePassSeries(signals.force(PIECE), (signals.steps, 2))
    M = sensors.fix_interval
    for begin, end in itertools.pairwise(edges):
        positions = np.full((end - begin, 2), np.nan)
        first_fix = -(-begin // M)
        positions[first_fix * M - begin :: M] = signals.fixes[first_fix : -(-end // M)]
        yield run_steps(estimator, np.ascontiguousarray(force[begin:end]), positions, first=begin)
