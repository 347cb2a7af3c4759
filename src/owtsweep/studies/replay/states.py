"""Collect the filters' estimates of acceleration and accelerometer bias, for a record's figures."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.figures.lines import POINTS, Envelope
from owtsweep.studies.hub.public import (
    Chain,
    Known,
    OnePassSeries,
    bias_of,
    has_acceleration,
    lag_of,
    resolve_all,
    state_chunks,
)
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.estimating import make_lanes
from owtsweep.studies.replay.record import cut_into_pieces, simulate_true_bias
from owtsweep.studies.replay.session import Alike, Session, raise_bound, skip_start


@dataclass
class FilterState:
    """One filter's estimates of acceleration and accelerometer bias, in NED coordinates and m/s^2.

    An estimate is stored at the time to which it refers, which may be earlier than the time at
    which the filter computed it. An envelope is a series reduced to few points, for a plot.

    acceleration: Estimates in the zoomed part of the record that the figure of acceleration shows,
        shape (n, 2); None if the filter's model has no acceleration.
    acceleration_bound, bias_bound: Largest absolute errors along x of acceleration and bias, after
        the first fifth of the record; 0 if the truth is unknown.
    bias: Envelopes of x and y of the bias R b^b over the whole record.
    bias_error: Envelope of the error of the bias along x; without values if the bias is not
        simulated.
    bias_range: Ranges of the bias after the first fifth of the record, shape (2, 2): rows x and y,
        columns least and greatest.
    """

    acceleration: Array | None
    bias: tuple[Envelope, Envelope]
    bias_error: Envelope
    bias_range: Array
    acceleration_bound: float = 0.0
    bias_bound: float = 0.0


@dataclass(frozen=True)
class FilterStates:
    """All filters' estimates of acceleration and accelerometer bias on a record, as envelopes.

    of: Scheme -> estimates of the scheme's filter.
    repeated: "acceleration" or "bias" -> schemes whose estimates equal those of a later scheme.
    true_bias: Envelopes of x and y of the simulated bias; None for recorded sensors.
    true_range: Ranges of the simulated bias (m/s^2), as `bias_range`; (+inf, -inf) for recorded
        sensors, or if no filter was run.
    """

    of: Mapping[str, FilterState]
    repeated: Mapping[str, frozenset[str]]
    true_bias: tuple[Envelope, Envelope] | None
    true_range: Array


def collect_filter_states(config: ReplayConfig, session: Session) -> FilterStates:
    """Run all filters on the record and collect their estimates of acceleration and bias.

    Only schemes with a kernel are run. If fixes are missing, no filter is run, because kernels need
    every fix.
    """
    record = session.record
    simulated = record.gnss == "simulated"
    true_bias = (Envelope(record.steps), Envelope(record.steps)) if simulated else None
    true_range = _empty_range()
    chains = _make_chains(config, session)
    states = {name: _new_state(chain, record.steps) for name, chain in chains.items()}
    accelerating = [name for name, state in states.items() if state.acceleration is not None]
    alike = {"acceleration": Alike(accelerating), "bias": Alike(states)}
    edges = cut_into_pieces(record.steps)
    runs = [_run_shifted(chain, session, edges) for chain in chains.values()]
    biases = simulate_true_bias(config, session.sensors, record.steps, 0) if simulated else None
    for begin in edges[:-1] if chains else ():
        pieces = dict(zip(states, (next(run) for run in runs), strict=True))
        truth = None if biases is None else next(biases)
        for name, piece in pieces.items():
            _add_piece(states[name], piece, truth, begin, session)
        alike["acceleration"].add({name: pieces[name][:, 2] for name in accelerating})
        alike["bias"].add({name: piece[:, 3] for name, piece in pieces.items()})
        if truth is not None and true_bias is not None:
            _widen(true_range, truth)
            for axis, envelope in enumerate(true_bias):
                envelope.add(truth[:, axis])
    repeated = {quantity: pairs.repeated() for quantity, pairs in alike.items()}
    return FilterStates(states, repeated, true_bias, true_range)


def _make_chains(config: ReplayConfig, session: Session) -> dict[str, Chain]:
    if not np.all(np.isfinite(session.signals.fixes)):
        return {}
    known = Known(session.sensors, config)
    return {
        scheme.name: scheme.kernel_for_runs(known, session.record.steps)
        for scheme in resolve_all(config.schemes, config)
        if scheme.name in session.names and scheme.batched == "chain"
    }


def _new_state(chain: Chain, steps: int) -> FilterState:
    estimated = steps - lag_of(chain)
    points = POINTS if estimated == steps else max(int(POINTS * estimated / steps), 8)
    x, y, error = (Envelope(estimated, points) for _ in range(3))
    acceleration = np.empty((0, 2)) if has_acceleration(chain) else None
    return FilterState(acceleration, (x, y), error, _empty_range())


def _run_shifted(chain: Chain, session: Session, edges: list[int]) -> Iterator[Array]:
    """Run a filter on a record; yield its states in pieces of shape (n, 4, 2).

    The second axis holds position, velocity, acceleration and the bias R b^b; the third holds x and
    y. The filter computes a state `lag_of(chain)` steps late. The state is moved back to the step
    to which it refers, so the last steps of the record are NaN.
    """
    lag, steps = lag_of(chain), session.record.steps
    chunks = state_chunks(chain, *make_lanes([session.signals], session.sensors))
    late = OnePassSeries(
        (chunk[:count].reshape(count, 8) for _, count, chunk in chunks), (steps, 8)
    )
    for begin, end in itertools.pairwise(edges):
        result = np.full((end - begin, 4, 2), np.nan)
        piece = late[begin + lag : end + lag].reshape(-1, 4, 2)
        result[: len(piece)] = piece
        result[:, 3] = bias_of(result, session.sensors)
        yield result


def _add_piece(
    state: FilterState, piece: Array, truth: Array | None, begin: int, session: Session
) -> None:
    """Append a piece of a filter's states, shape (n, 4, 2), to the values that figures show.

    `truth` is the true bias in this piece, shape (n, 2) in m/s^2, if known; `begin` is its first
    step.
    """
    end, late = begin + len(piece), slice(max(skip_start(session.record) - begin, 0), None)
    acceleration, bias = piece[:, 2], piece[:, 3]
    if state.acceleration is not None:
        window = session.windows["acceleration"]
        inside = slice(max(window.start - begin, 0), max(window.stop - begin, 0))
        state.acceleration = np.concatenate([state.acceleration, acceleration[inside]])
        if session.record.acceleration is not None:
            error = acceleration[:, 0] - session.record.acceleration[begin:end, 0]
            state.acceleration_bound = raise_bound(state.acceleration_bound, np.abs(error[late]))
    for axis, envelope in enumerate(state.bias):
        envelope.add(bias[:, axis])
    _widen(state.bias_range, bias[late])
    if truth is not None:
        error = bias[:, 0] - truth[:, 0]
        state.bias_error.add(error)
        state.bias_bound = raise_bound(state.bias_bound, np.abs(error[late]))


def _empty_range() -> Array:
    return np.array([[np.inf, -np.inf], [np.inf, -np.inf]])


def _widen(limits: Array, values: Array) -> None:
    """Widen ranges of x and y in place to hold the finite of the values, shape (n, 2)."""
    finite = np.isfinite(values)
    limits[:, 0] = np.minimum(limits[:, 0], np.min(values, axis=0, initial=np.inf, where=finite))
    limits[:, 1] = np.maximum(limits[:, 1], np.max(values, axis=0, initial=-np.inf, where=finite))
