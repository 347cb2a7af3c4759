"""One scheme over a record: estimates, their deviations, innovations, some steps at a time."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub import batch
from owtsweep.studies.hub.chain import Chain, chain_for_runs
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Estimate, Estimator, Scheme, Sensors
from owtsweep.studies.hub.one_pass import OnePassSeries
from owtsweep.studies.hub.sensors import Measurements
from owtsweep.studies.replay.measuring import PIECE, Signals, given

if TYPE_CHECKING:
    from owtsweep.studies.hub.online.estimator import OnlineEstimator


@dataclass(frozen=True)
class Estimated:
    """A scheme's estimates in NED, of a whole record or of a piece of it.

    Attributes
    ----------
    state
        (steps, 4): x, y (m), v_x, v_y (m/s).
    covariance
        (steps, 2, 2, 2): of (p, v) for each axis (second index); NaN where there is none.
    innovation, innovation_variance
        (steps, 2): of x and y (m), their variances (m^2); NaN at steps without.
    """

    state: Array
    covariance: Array
    innovation: Array
    innovation_variance: Array

    @property
    def deviation(self) -> Array:
        """(steps, 4): standard deviations of x, y, v_x, v_y; NaN without a covariance."""
        P = self.covariance
        return np.asarray(np.sqrt(np.concatenate([P[..., 0, 0], P[..., 1, 1]], axis=1)))

    def part(self, steps: slice) -> Estimated:
        """The same of some steps, without a copy."""
        return Estimated(
            self.state[steps], self.covariance[steps], self.innovation[steps],
            self.innovation_variance[steps],
        )  # fmt: skip

    def copy(self) -> Estimated:
        """The same in memory of its own, so that a part does not hold the whole."""
        return Estimated(*(np.array(series) for series in vars(self).values()))

    @staticmethod
    def joined(pieces: Sequence[Estimated]) -> Estimated:
        """Pieces that follow each other, in one."""
        series = zip(*(vars(piece).values() for piece in pieces), strict=True)
        return Estimated(*(np.concatenate(own) for own in series))


def estimate(
    config: HubConfig, scheme: Scheme, sensors: Sensors, measured: Measurements
) -> Estimated:
    """Run a scheme over a record, all at once. See `estimates`."""
    signals = [given(measured)]
    return next(estimates(config, scheme, sensors, signals, [0, signals[0].steps]))[0]


def estimates(
    config: HubConfig,
    scheme: Scheme,
    sensors: Sensors,
    several: Sequence[Signals],
    edges: Sequence[int],
) -> Iterator[tuple[Estimated, ...]]:
    """Run a scheme over some replicates of a record, piece by piece.

    With every fix there the batch engine runs it, on all replicates side by side; where fixes are
    missing its gains depend on which, and the online form computes them as it goes. The reference
    engine, and a user's scheme without either, runs one `update` per step. The estimates do not
    depend on the pieces, nor on what runs beside them.

    Parameters
    ----------
    edges
        0, ..., steps: where pieces begin and end.

    Yields
    ------
    tuple
        Each replicate's estimates of the steps between two edges.

    Raises
    ------
    ValueError
        If an estimate has the wrong shape or is not finite, naming the step.
    """
    if config.engine == "batch":
        complete = all(bool(np.all(np.isfinite(signals.fixes))) for signals in several)
        if complete and hasattr(scheme, "kernel"):
            chain = chain_for_runs(scheme, sensors, config, several[0].steps)
            return _by_kernel(chain, sensors, several, edges)
        if hasattr(scheme, "stream"):
            return _side_by_side(
                _online(scheme.stream(sensors, config), sensors, signals, edges)
                for signals in several
            )
    return _side_by_side(
        _step_by_step(scheme.start(sensors, config), sensors, signals, edges) for signals in several
    )


def _side_by_side(runs: Iterator[Iterator[Estimated]]) -> Iterator[tuple[Estimated, ...]]:
    return zip(*runs, strict=True)


def north_east(signals: Signals, sensors: Sensors) -> Iterator[Array]:
    """The specific force in NED, (steps, 2) m/s^2, piece by piece."""
    return (piece @ sensors.rotation.T for piece in signals.force(PIECE))


def rows_of(several: Sequence[Signals], sensors: Sensors) -> tuple[OnePassSeries, Array]:
    """Specific force in NED and fixes of some replicates as the batch engine's lanes."""
    pieces = zip(*(north_east(signals, sensors) for signals in several), strict=True)
    beside = (np.concatenate(parts, axis=1) for parts in pieces)
    fixes = np.concatenate([signals.fixes for signals in several], axis=1)
    return OnePassSeries(beside, (several[0].steps, 2 * len(several))), fixes


def _by_kernel(
    chain: Chain, sensors: Sensors, several: Sequence[Signals], edges: Sequence[int]
) -> Iterator[tuple[Estimated, ...]]:
    found = batch.chunks(chain, *rows_of(several, sensors))
    first, count, chunk = next(found)
    for begin, end in itertools.pairwise(edges):
        state = np.empty((len(several), end - begin, 4))
        innovation = np.empty((len(several), end - begin, 2))
        at = begin
        while at < end:
            if at == first + count:
                first, count, chunk = next(found)
            stop = min(first + count, end)
            source, target = slice(at - first, stop - first), slice(at - begin, stop - begin)
            for replicate in range(len(several)):
                lanes = slice(2 * replicate, 2 * replicate + 2)
                state[replicate, target, :2] = chunk.position[source, lanes]
                state[replicate, target, 2:] = chunk.velocity[source, lanes]
                innovation[replicate, target] = chunk.innovation[source, lanes]
            at = stop
        row = chain.gains.row(np.arange(begin, end))
        fresh = chain.gains.fresh[row]
        innovation[:, ~fresh] = np.nan
        variance = np.where(fresh, chain.gains.innovation_variance[row], np.nan)
        covariance = _of_both_axes(chain.covariance[row])
        both = np.broadcast_to(variance[:, None], (end - begin, 2))
        made = [
            Estimated(*own, both)
            for own in zip(state, itertools.repeat(covariance), innovation, strict=False)
        ]
        del state, innovation, covariance, variance, both, row  # not two pieces of a long record
        yield tuple(made.pop(0) for _ in several)


def _of_both_axes(covariance: Array) -> Array:
    """(steps, 2, 2) as (steps, 2, 2, 2), alike for both axes, without a copy."""
    steps = len(covariance)
    return np.broadcast_to(covariance[:, None], (steps, 2, 2, 2))


def _due(
    sensors: Sensors, signals: Signals, edges: Sequence[int]
) -> Iterator[tuple[int, Array, Array]]:
    """Piece by piece: its first step, specific force and positions, NaN where no fix is due."""
    force = OnePassSeries(signals.force(PIECE), (signals.steps, 2))
    M = sensors.fix_interval
    for begin, end in itertools.pairwise(edges):
        positions = np.full((end - begin, 2), np.nan)
        first = -(-begin // M)
        positions[first * M - begin :: M] = signals.fixes[first : -(-end // M)]
        yield begin, np.ascontiguousarray(force[begin:end]), positions


def _online(
    estimator: OnlineEstimator, sensors: Sensors, signals: Signals, edges: Sequence[int]
) -> Iterator[Estimated]:
    for _, force, positions in _due(sensors, signals, edges):
        found = estimator.run(force, positions)
        yield Estimated(
            state=found.state,
            covariance=_of_both_axes(found.covariance),
            innovation=found.innovation,
            innovation_variance=np.broadcast_to(
                found.innovation_variance[:, None], found.innovation.shape
            ),
        )


def _step_by_step(
    estimator: Estimator, sensors: Sensors, signals: Signals, edges: Sequence[int]
) -> Iterator[Estimated]:
    for begin, force, positions in _due(sensors, signals, edges):
        steps = len(force)
        state = np.empty((steps, 4))
        covariance = np.full((steps, 2, 2, 2), np.nan)
        innovation, variance = np.full((2, steps, 2), np.nan)
        due = np.all(np.isfinite(positions), axis=1)
        for k in range(steps):
            found: Any = estimator.update(force[k], positions[k] if due[k] else None)
            if not isinstance(found, Estimate):
                raise TypeError(f"update gave a {type(found).__name__}, not an owtsweep.Estimate")
            state[k, :2], state[k, 2:] = found.position, found.velocity
            if found.covariance is not None:
                both = np.asarray(found.covariance).reshape(2, 2, 2, 2)  # (p, v) x (x, y), twice
                covariance[k] = np.einsum("iaja->aij", both)
            if found.innovation is not None:
                innovation[k] = found.innovation.value
                variance[k] = np.diagonal(found.innovation.covariance)
        if not np.all(np.isfinite(state)):
            step = begin + int(np.argmax(~np.isfinite(state).all(axis=1)))
            raise ValueError(f"the estimate of step {step} is not finite")
        yield Estimated(state, covariance, innovation, variance)
