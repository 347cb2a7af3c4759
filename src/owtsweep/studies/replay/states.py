"""Collect the filters' estimates of acceleration and accelerometer bias, for a record's figures."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from typing import NamedTuple

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
from owtsweep.studies.replay.session import Session


class FilterState(NamedTuple):
    """One filter's estimates of acceleration and accelerometer bias, in NED and m/s^2.

    An estimate is stored at the time to which it refers, not when the filter computed it.

    acceleration: In the part of the record that the figure shows, shape (n, 2); None if the
        filter's model has no acceleration.
    bias: Envelopes of x and y of the bias R b^b over the whole record.
    bias_error: Envelope of the error of the bias along x; empty if the bias is not simulated.
    """

    acceleration: Array | None
    bias: tuple[Envelope, Envelope]
    bias_error: Envelope


class FilterStates(NamedTuple):
    """All filters' estimates on a record: scheme -> state; and the envelopes of the true bias.

    `true_bias` is None for recorded sensors.
    """

    of: Mapping[str, FilterState]
    true_bias: tuple[Envelope, Envelope] | None


def collect_filter_states(config: ReplayConfig, session: Session) -> FilterStates:
    """Run all filters on the record and collect their estimates of acceleration and bias.

    Only schemes with a kernel are run. If fixes are missing, no filter is run, because kernels need
    every fix.
    """
    record, simulated = session.record, session.record.gnss == "simulated"
    chains = _make_chains(config, session)

    def biases() -> Iterator[Array]:
        return simulate_true_bias(config, session.sensors, record.steps, 0)

    true_bias = None
    if simulated:
        true_bias = (Envelope(record.steps), Envelope(record.steps))
        for truth in biases() if chains else ():
            _add(true_bias, truth)
    states = {
        name: _collect(chain, session, biases() if simulated else itertools.repeat(None))
        for name, chain in chains.items()
    }
    return FilterStates(states, true_bias)


def _make_chains(config: ReplayConfig, session: Session) -> dict[str, Chain]:
    if not np.all(np.isfinite(session.signals.fixes)):
        return {}
    known = Known(session.sensors, config)
    return {
        scheme.name: scheme.kernel_for_runs(known, session.record.steps)
        for scheme in resolve_all(config.schemes, config)
        if scheme.name in session.names and scheme.batched == "chain"
    }


def _collect(chain: Chain, session: Session, biases: Iterator[Array | None]) -> FilterState:
    steps, window = session.record.steps, session.windows["acceleration"]
    estimated = steps - lag_of(chain)
    points = POINTS if estimated == steps else max(int(POINTS * estimated / steps), 8)
    x, y, error = (Envelope(estimated, points) for _ in range(3))
    shown, begin = [], 0
    for piece, truth in zip(_run_shifted(chain, session), biases, strict=False):
        shown.append(piece[max(window.start - begin, 0) : max(window.stop - begin, 0), 2])
        _add((x, y), piece[:, 3])
        if truth is not None:
            error.add(piece[:, 3, 0] - truth[:, 0])
        begin += len(piece)
    acceleration = np.concatenate(shown) if has_acceleration(chain) else None
    return FilterState(acceleration, (x, y), error)


def _add(envelopes: tuple[Envelope, Envelope], values: Array) -> None:
    for axis, envelope in enumerate(envelopes):
        envelope.add(values[:, axis])


def _run_shifted(chain: Chain, session: Session) -> Iterator[Array]:
    """Yield a filter's states in pieces of shape (n, 4, 2).

    The second axis holds position, velocity, acceleration and the bias R b^b; the third x and y.
    The filter computes a state `lag_of(chain)` steps late; it is moved back to the step to which it
    refers, so the last steps of the record are NaN.
    """
    lag, steps = lag_of(chain), session.record.steps
    chunks = state_chunks(chain, *make_lanes([session.signals], session.sensors))
    late = OnePassSeries(
        (chunk[:count].reshape(count, 8) for _, count, chunk in chunks), (steps, 8)
    )
    for begin, end in itertools.pairwise(cut_into_pieces(steps)):
        result = np.full((end - begin, 4, 2), np.nan)
        piece = late[begin + lag : end + lag].reshape(-1, 4, 2)
        result[: len(piece)] = piece
        result[:, 3] = bias_of(result, session.sensors)
        yield result
