"""Collect what a record's figures show: estimates, and the filters' acceleration and bias.

Schemes run on replicate 0 piece by piece, and only the steps that a figure shows are kept.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.trajectory import Trajectory, join
from owtsweep.figures.lines import POINTS, Envelope
from owtsweep.studies.hub import public as hub
from owtsweep.studies.hub.public import Scheme, Sensors, make_sensors, resolve_all
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.estimating import SchemeFailed, make_lanes, run_scheme
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.record import (
    ReplayRecord,
    Signals,
    cut_into_pieces,
    listen,
    simulate_true_bias,
)

#: Length of the longest "whole" view, s.
SPAN = 200.0
#: Zoomed view -> its length, s.
ZOOMS = {"zoom": 15.0, "acceleration": 6.0}
#: Zoomed views leave out this time at the start, while estimates settle, s.
SETTLING = 20.0
#: Quantity -> its columns of the state.
COLUMNS = {"position": slice(0, 2), "velocity": slice(2, 4)}


def choose_windows(record: ReplayRecord, positions: Iterable[Array]) -> dict[str, slice[int]]:
    """Choose the parts of a record that figures show: name of the part -> its steps.

    "whole" is the record's beginning, at most `SPAN` s; "zoom" and "acceleration" lie around the
    largest motion after `SETTLING` s.

    positions: true or estimated ones, in pieces of shape (n, 2), m; NaN where unknown.
    """
    windows = {"whole": _select(record, record.begin, record.begin + SPAN)}
    for name, step in _find_largest_motion(record, positions).items():
        start = max(record.begin + record.step * step - ZOOMS[name] / 2, record.begin)
        windows[name] = _select(record, start, start + ZOOMS[name])
    return windows


def _find_largest_motion(record: ReplayRecord, positions: Iterable[Array]) -> dict[str, int]:
    # of steps whose zoomed part lies inside the record; the middle of the record if there is none
    found = dict.fromkeys(ZOOMS, (0.0, record.steps // 2))
    begin = 0
    for xy in positions:
        time = record.time_at(slice(begin, begin + len(xy)))
        size = np.where(np.isfinite(xy[:, 0]), np.hypot(xy[:, 0], xy[:, 1]), -1.0)
        for name, length in ZOOMS.items():
            first, last = record.begin + SETTLING + length / 2, record.end - length / 2
            here = np.where((time >= first) & (time <= last), size, -1.0)
            at = int(np.argmax(here))
            if here[at] > found[name][0]:
                found[name] = (float(here[at]), begin + at)
        begin += len(xy)
    return {name: step for name, (_, step) in found.items()}


def _select(record: ReplayRecord, start: float, end: float) -> slice[int]:
    first = int(np.ceil((start - record.begin) / record.step - 1e-6))
    last = int(np.floor((end - record.begin) / record.step + 1e-6))
    return slice(first, min(last + 1, record.steps))


@dataclass(frozen=True)
class Session:
    """The data for a record's figures: the record, its measurements, and the schemes' estimates.

    record, sensors, signals: of replicate 0.
    windows: part of the record ("whole", "zoom" or "acceleration") -> its steps.
    seen: part of the record -> scheme -> estimates there.
    failed: scheme that failed -> the reason.
    """

    record: ReplayRecord
    sensors: Sensors
    signals: Signals
    windows: Mapping[str, slice[int]]
    seen: Mapping[str, Mapping[str, Trajectory]]
    failed: Mapping[str, str]

    @property
    def names(self) -> list[str]:
        """The names of the schemes that have estimates."""
        return list(self.seen["whole"])


def find_repeated(series: Mapping[str, Array]) -> set[str]:
    """Return the names of series that equal a later one but for rounding."""
    names = list(series)
    return {
        one
        for number, one in enumerate(names)
        for other in names[number + 1 :]
        if series[one].shape == series[other].shape
        and np.allclose(series[one], series[other], rtol=1e-9, atol=1e-12, equal_nan=True)
    }


def run_session(config: ReplayConfig, file: str) -> Session:
    """Run all schemes on replicate 0 of the record in a file, and collect the data for its figures.

    Raises InputError if the file cannot be read.
    """
    record = load_record(config, file)
    sensors = make_sensors(config.sensors)
    signals = listen(config, sensors, record, 0)
    edges = cut_into_pieces(record.steps)
    windows: dict[str, slice[int]] = {}
    seen: dict[str, dict[str, Trajectory]] = {name: {} for name in ("whole", *ZOOMS)}
    failed: dict[str, str] = {}
    for scheme in resolve_all(config.schemes, config):
        try:
            if not windows:
                windows = choose_windows(record, _locate(config, scheme, sensors, record, signals))
            run = run_scheme(config, scheme, sensors, signals, edges)
            kept: dict[str, list[Trajectory]] = {name: [] for name in windows}
            for begin, piece in zip(edges, run, strict=False):
                for name, steps in windows.items():
                    inside = slice(max(steps.start - begin, 0), max(steps.stop - begin, 0))
                    kept[name].append(piece.part(inside).copy())
        except SchemeFailed as error:
            failed[error.name] = str(error)
        else:
            for name, parts in kept.items():
                seen[name][scheme.name] = join(parts)
    windows = windows or choose_windows(record, ())
    return Session(record, sensors, signals, windows, seen, failed)


def _locate(
    config: ReplayConfig, scheme: Scheme, sensors: Sensors, record: ReplayRecord, signals: Signals
) -> Iterator[Array]:
    edges = cut_into_pieces(record.steps)
    if (truth := record.position) is not None:
        return (truth[first:last] for first, last in pairwise(edges))
    run = run_scheme(config, scheme, sensors, signals, edges)
    return (piece.state[:, :2] for piece in run)


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


def _make_chains(config: ReplayConfig, session: Session) -> dict[str, hub.Chain]:
    if not np.all(np.isfinite(session.signals.fixes)):
        return {}
    known = hub.Known(session.sensors, config)
    return {
        scheme.name: scheme.kernel_for_runs(known, session.record.steps)
        for scheme in hub.resolve_all(config.schemes, config)
        if scheme.name in session.names and scheme.batched == "chain"
    }


def _collect(chain: hub.Chain, session: Session, biases: Iterator[Array | None]) -> FilterState:
    steps, window = session.record.steps, session.windows["acceleration"]
    estimated = steps - hub.lag_of(chain)
    points = POINTS if estimated == steps else max(int(POINTS * estimated / steps), 8)
    x, y, error = (Envelope(estimated, points) for _ in range(3))
    shown, begin = [], 0
    for piece, truth in zip(_run_shifted(chain, session), biases, strict=False):
        shown.append(piece[max(window.start - begin, 0) : max(window.stop - begin, 0), 2])
        _add((x, y), piece[:, 3])
        if truth is not None:
            error.add(piece[:, 3, 0] - truth[:, 0])
        begin += len(piece)
    acceleration = np.concatenate(shown) if hub.has_acceleration(chain) else None
    return FilterState(acceleration, (x, y), error)


def _add(envelopes: tuple[Envelope, Envelope], values: Array) -> None:
    for axis, envelope in enumerate(envelopes):
        envelope.add(values[:, axis])


def _run_shifted(chain: hub.Chain, session: Session) -> Iterator[Array]:
    """Yield a filter's states in pieces of shape (n, 4, 2).

    The second axis holds position, velocity, acceleration and the bias R b^b; the third x and y.
    The filter computes a state `lag_of(chain)` steps late; it is moved back to the step to which it
    refers, so the last steps of the record are NaN.
    """
    lag, steps = hub.lag_of(chain), session.record.steps
    chunks = hub.state_chunks(chain, *make_lanes([session.signals], session.sensors))
    late = hub.OnePassSeries(
        (chunk[:count].reshape(count, 8) for _, count, chunk in chunks), (steps, 8)
    )
    for begin, end in itertools.pairwise(cut_into_pieces(steps)):
        result = np.full((end - begin, 4, 2), np.nan)
        piece = late[begin + lag : end + lag].reshape(-1, 4, 2)
        result[: len(piece)] = piece
        result[:, 3] = hub.bias_of(result, session.sensors)
        yield result
