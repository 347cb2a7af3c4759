"""What the filters believe besides position and velocity: acceleration and bias."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub import batch
from owtsweep.studies.hub.chain import Chain, chain_for_runs
from owtsweep.studies.hub.schemes import resolve_all
from owtsweep.studies.replay.alike import Alike
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.envelope import POINTS, Envelope
from owtsweep.studies.replay.estimating import rows_of
from owtsweep.studies.replay.measuring import pieces_of, simulated_bias
from owtsweep.studies.replay.session import Session, largest_of, settled_from


@dataclass
class FilterState:
    """One filter's states, NED, each at the moment that it is about; SI units.

    Attributes
    ----------
    acceleration
        (n, 2) in the window "acceleration"; None for a model without that state.
    acceleration_bound, bias_bound
        The largest error of x after a fifth of the record; 0 without a truth.
    bias
        Envelopes of x and y of R b^b over the whole record.
    bias_error
        That of the error of x, if the bias is simulated.
    bias_range
        (2, 2) least and greatest of x and of y after a fifth of the record.
    """

    acceleration: Array | None
    bias: tuple[Envelope, Envelope]
    bias_error: Envelope
    bias_range: Array
    acceleration_bound: float = 0.0
    bias_bound: float = 0.0


@dataclass(frozen=True)
class FilterStates:
    """The states of all filters.

    Attributes
    ----------
    of
        Scheme -> its filter's.
    repeated
        "acceleration" or "bias" -> schemes whose line is that of a later one.
    true_bias
        Envelopes of x and y of the simulated bias, which only a motion has.
    true_range
        (2, 2) its least and greatest.
    """

    of: Mapping[str, FilterState]
    repeated: Mapping[str, frozenset[str]]
    true_bias: tuple[Envelope, Envelope] | None
    true_range: Array


#: Of figures that need none.
NONE = FilterStates({}, {}, None, np.empty((0, 2)))


def filter_states(config: ReplayConfig, session: Session) -> FilterStates:
    """The filters' states; none where fixes are missing (kernels need every one)."""
    record = session.record
    simulated = record.kind == "motion"
    true_bias = (Envelope(record.steps), Envelope(record.steps)) if simulated else None
    true_range = _nothing()
    chains = _chains(config, session)
    found = {name: _new(chain, record.steps) for name, chain in chains.items()}
    moving = [name for name, own in found.items() if own.acceleration is not None]
    alike = {"acceleration": Alike(moving), "bias": Alike(list(found))}
    edges = pieces_of(record.steps)
    runs = [_moved(chain, session, edges) for chain in chains.values()]
    biases = simulated_bias(config, session.sensors, record.steps, 0) if simulated else None
    for begin in edges[:-1] if chains else ():
        pieces = dict(zip(found, (next(run) for run in runs), strict=True))
        truth = None if biases is None else next(biases)
        for name, piece in pieces.items():
            _take(found[name], piece, truth, begin, session)
        alike["acceleration"].add([pieces[name][:, 2] for name in moving])
        alike["bias"].add([piece[:, 3] for piece in pieces.values()])
        if truth is not None and true_bias is not None:
            _widen(true_range, truth)
            for axis, envelope in enumerate(true_bias):
                envelope.add(truth[:, axis])
    repeated = {quantity: pairs.repeated() for quantity, pairs in alike.items()}
    return FilterStates(found, repeated, true_bias, true_range)


def _chains(config: ReplayConfig, session: Session) -> dict[str, Chain]:
    if not np.all(np.isfinite(session.signals.fixes)):
        return {}
    return {
        scheme.name: chain_for_runs(scheme, session.sensors, config, session.record.steps)
        for scheme in resolve_all(config.schemes, config)
        if scheme.name in session.names and hasattr(scheme, "kernel")
    }


def _new(chain: Chain, steps: int) -> FilterState:
    known = steps - _lag(chain)
    points = POINTS if known == steps else max(int(POINTS * known / steps), 8)
    x, y, error = (Envelope(known, points) for _ in range(3))
    has_acceleration = bool(np.any(chain.axis.force_row))
    return FilterState(np.empty((0, 2)) if has_acceleration else None, (x, y), error, _nothing())


def _lag(chain: Chain) -> int:
    """Steps by which the filter's time is late."""
    return chain.filter.input_delay + chain.filter.window


def _moved(chain: Chain, session: Session, edges: list[int]) -> Iterator[Array]:
    """(n, 4, 2) p, v, a and R b^b between two edges each, NaN at the end, where none is."""
    lag, steps = _lag(chain), session.record.steps
    chunks = batch.state_chunks(chain, *rows_of([session.signals], session.sensors))
    gravity = np.array(session.sensors.gravity)
    first, count, chunk = next(chunks)
    for begin, end in itertools.pairwise(edges):
        result = np.full((end - begin, 4, 2), np.nan)
        at = begin + lag
        while at < min(end + lag, steps):
            while at >= first + count:
                first, count, chunk = next(chunks)
            stop = min(first + count, end + lag)
            result[at - lag - begin : stop - lag - begin] = chunk[at - first : stop - first]
            at = stop
        result[:, 3] = gravity - result[:, 3]
        yield result


def _take(
    state: FilterState, piece: Array, truth: Array | None, begin: int, session: Session
) -> None:
    """Keep of a piece what figures show."""
    end, late = begin + len(piece), slice(max(settled_from(session.record) - begin, 0), None)
    acceleration, bias = piece[:, 2], piece[:, 3]
    if state.acceleration is not None:
        window = session.windows["acceleration"]
        own = slice(max(window.start - begin, 0), max(window.stop - begin, 0))
        state.acceleration = np.concatenate([state.acceleration, acceleration[own]])
        if session.record.acceleration is not None:
            error = acceleration[:, 0] - session.record.acceleration[begin:end, 0]
            state.acceleration_bound = largest_of(state.acceleration_bound, np.abs(error[late]))
    for axis, envelope in enumerate(state.bias):
        envelope.add(bias[:, axis])
    _widen(state.bias_range, bias[late])
    if truth is not None:
        error = bias[:, 0] - truth[:, 0]
        state.bias_error.add(error)
        state.bias_bound = largest_of(state.bias_bound, np.abs(error[late]))


def _nothing() -> Array:
    """(2, 2) least and greatest of x and of y before anything was seen."""
    return np.array([[np.inf, -np.inf], [np.inf, -np.inf]])


def _widen(known: Array, values: Array) -> None:
    """Let ranges take in (n, 2) further values, where these are finite."""
    there = np.isfinite(values)
    known[:, 0] = np.minimum(known[:, 0], np.min(values, axis=0, initial=np.inf, where=there))
    known[:, 1] = np.maximum(known[:, 1], np.max(values, axis=0, initial=-np.inf, where=there))
