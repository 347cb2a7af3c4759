"""Collect the lines of the figures that show a record over time.

Position and velocity are those of the stored estimates, of replicate 0. Acceleration and bias are
not stored, so filters run again for them, piece by piece.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.figures.lines import POINTS, Envelope, Line, Pair, make_line, make_pair
from owtsweep.studies.hub import public as hub
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.estimating import DEVIATIONS, STATES, make_lanes, rotate_force
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.measures import find_judging_steps, foresee_fixes
from owtsweep.studies.replay.record import ReplayRecord, cut_into_pieces, listen, simulate_true_bias

#: Length of the longest "whole" view, s.
SPAN = 200.0
#: Zoomed view -> its length, s.
ZOOMS = {"zoom": 15.0, "acceleration": 6.0}
#: Zoomed views leave out this time at the start, while estimates settle, s.
SETTLING = 20.0
#: Quantity -> its columns of the state.
COLUMNS = {"position": slice(0, 2), "velocity": slice(2, 4)}


@dataclass(frozen=True)
class Traces:
    """The contents of a figure that shows one quantity over time; what is None is not shown.

    view: First and last time shown, in s.
    lines: Scheme -> the lines of its estimates of x and y, without schemes that equal a later one.
    errors: Scheme -> the line of its errors of x; empty if the truth is unknown.
    truth, imu: Lines of x and y of the true quantity and of the IMU's measurements.
    fixes: Times of arrival of the fixes, shape (n,), and the fixes, shape (n, 2).
    deviations: Scheme -> times, and standard deviations of x that the scheme states.
    residuals: Scheme -> times, and distances along x from the fix that tells of that time later,
        over the standard deviation that is expected of them; empty if the truth is known.
    """

    view: tuple[float, float]
    lines: Mapping[str, Pair]
    errors: Mapping[str, Line]
    truth: Pair | None = None
    imu: Pair | None = None
    fixes: tuple[Array, Array] | None = None
    deviations: Mapping[str, tuple[Array, Array]] = field(default_factory=dict)
    residuals: Mapping[str, tuple[Array, Array]] = field(default_factory=dict)

    def find_range(self, lines: Iterable[Line]) -> tuple[float, float]:
        """Return the least and the greatest value of lines after the first fifth of the view."""
        start = self.view[0] + 0.2 * (self.view[1] - self.view[0])
        late = [values[time >= start] for line in lines for time, values in line]
        values = np.concatenate([*late, np.empty(0)])
        return (float(values.min()), float(values.max())) if len(values) else (0.0, 0.0)


@dataclass
class Session:
    """What the figures of a record share: its data of replicate 0, and the stored estimates.

    advised: the recommended scheme: it is drawn on top, its ±1.96 standard deviations as a band.
    failed: scheme that failed -> the reason.
    estimates: the Parquet file of the estimates.

    Raises InputError if record or estimates cannot be read.
    """

    config: ReplayConfig
    file: str
    advised: str | None
    failed: Mapping[str, str]
    estimates: Path

    def __post_init__(self) -> None:
        from pyarrow import parquet

        self.record = load_record(self.config, self.file)
        self.sensors = hub.make_sensors(self.config.sensors)
        self.signals = listen(self.config, self.sensors, self.record, 0)
        try:
            stored = parquet.read_metadata(self.estimates)
        except (OSError, ValueError) as error:
            raise InputError(f"{self.estimates}: the estimates cannot be read ({error})") from None
        groups = (stored.row_group(number) for number in range(stored.num_row_groups))
        #: The names of the schemes that have estimates.
        self.names = list(dict.fromkeys(group.column(1).statistics.min for group in groups))

    def read(
        self, name: str, steps: slice[int], columns: Sequence[str] = (*STATES, *DEVIATIONS)
    ) -> Array:
        """Return columns of a scheme's estimates in a slice, shape (n, columns); x and y first."""
        from pyarrow import parquet

        first, last = self.record.time_at(steps)[[0, -1]]
        half = 0.5 * self.record.step
        inside = [("scheme", "==", name), ("time", ">", first - half), ("time", "<", last + half)]
        table = parquet.read_table(
            self.estimates, columns=list(columns), filters=inside, use_threads=False
        )
        values = np.column_stack([column.to_numpy() for column in table.columns])
        values[:, :2] -= self.record.origin
        return values

    @cached_property
    def windows(self) -> dict[str, slice[int]]:
        """The parts of the record that figures show, with their steps (see `choose_windows`)."""
        position = self.record.position
        if position is None:
            position = self.read(self.names[0], slice(None), STATES[:2])
        return choose_windows(self.record, position)

    @cached_property
    def chains(self) -> dict[str, hub.Chain]:
        """The schemes with a kernel; none if fixes are missing, because kernels need every fix."""
        if not np.all(np.isfinite(self.signals.fixes)):
            return {}
        known = hub.Known(self.sensors, self.config)
        return {
            scheme.name: scheme.kernel_for_runs(known, self.record.steps)
            for scheme in hub.resolve_all(self.config.schemes, self.config)
            if scheme.name in self.names and scheme.batched == "chain"
        }


def choose_windows(record: ReplayRecord, position: Array) -> dict[str, slice[int]]:
    """Choose the parts of a record that figures show: name of the part -> its steps.

    "whole" is the record's beginning, at most `SPAN` s; "zoom" and "acceleration" lie around the
    largest motion after `SETTLING` s, or around the middle of a record that is too short.

    position: the true or an estimated one, shape (steps, 2), m; NaN where unknown.
    """
    time, size = record.time_at(slice(None)), np.nan_to_num(np.hypot(*position.T))
    windows = {"whole": _select(record, record.begin, record.begin + SPAN)}
    for name, length in ZOOMS.items():
        first, last = record.begin + SETTLING + length / 2, record.end - length / 2
        inside = np.where((time >= first) & (time <= last), size, 0.0)
        step = int(np.argmax(inside)) if np.any(inside) else record.steps // 2
        start = max(record.begin + record.step * step - length / 2, record.begin)
        windows[name] = _select(record, start, start + length)
    return windows


def _select(record: ReplayRecord, start: float, end: float) -> slice[int]:
    first = int(np.ceil((start - record.begin) / record.step - 1e-6))
    last = int(np.floor((end - record.begin) / record.step + 1e-6))
    return slice(first, min(last + 1, record.steps))


def find_distinct(series: Mapping[str, Array]) -> list[str]:
    """Return the names of series without those that equal a later one but for rounding."""
    repeated = {
        one
        for one, other in itertools.combinations(series, 2)
        if series[one].shape == series[other].shape
        and np.allclose(series[one], series[other], rtol=1e-9, atol=1e-12, equal_nan=True)
    }
    return [name for name in series if name not in repeated]


def collect_traces(session: Session, quantity: str, *, zoom: bool) -> Traces:
    """Collect the lines of a figure that shows one quantity over time.

    `zoom` applies to position and velocity; the acceleration is always zoomed in, the bias never.
    """
    if quantity == "bias":
        return _trace_bias(session)
    if quantity == "acceleration":
        return _trace_acceleration(session)
    return _trace_state(session, quantity, session.windows["zoom" if zoom else "whole"])


def _trace(
    session: Session, quantity: str, steps: slice[int], estimates: Mapping[str, Array]
) -> Traces:
    """Return estimates (n, 2) by scheme beside the truth, if that is known."""
    time = session.record.time_at(steps)
    view = float(time[0]), float(time[-1])
    shown = {name: estimates[name] for name in find_distinct(estimates)}
    lines = {name: make_pair(time, values) for name, values in shown.items()}
    series: Array | None = getattr(session.record, quantity)
    if series is None:
        return Traces(view, lines, {})
    truth = series[steps]
    errors = {name: make_line(time, each[:, 0] - truth[:, 0]) for name, each in shown.items()}
    return Traces(view, lines, errors, truth=make_pair(time, truth))


def _trace_state(session: Session, quantity: str, steps: slice[int]) -> Traces:
    time, columns = session.record.time_at(steps), COLUMNS[quantity]
    seen = {name: session.read(name, steps) for name in session.names}
    states = {name: values[:, columns] for name, values in seen.items()}
    traces = _trace(session, quantity, steps, states)
    deviations = {name: (time, seen[name][:, 4 + columns.start]) for name in traces.lines}
    traces = replace(traces, deviations=deviations)
    if quantity != "position":
        return traces
    fixes, sensors = session.signals.fixes, session.sensors
    M = sensors.fix_interval
    number = np.arange(-(-steps.start // M), -(-steps.stop // M))
    traces = replace(traces, fixes=(time[M * number - steps.start], fixes[number]))
    if traces.truth is not None:
        return traces
    judging = find_judging_steps(len(fixes), sensors)
    judged = np.flatnonzero((judging >= steps.start) & (judging < steps.stop))
    at = judging[judged] - steps.start
    residuals = {}
    for scheme in traces.lines:
        state, deviation = np.split(seen[scheme], 2, axis=1)
        apart = fixes[judged, 0] - foresee_fixes(state[at], sensors)[:, 0]
        scaled = apart / np.hypot(deviation[at, 0], sensors.position_sigma)
        if np.any(there := np.isfinite(scaled)):
            residuals[scheme] = time[at][there], scaled[there]
    return replace(traces, residuals=residuals)


def _trace_acceleration(session: Session) -> Traces:
    steps, shape = session.windows["acceleration"], (session.record.steps, 2)
    estimates = {
        name: hub.OnePassSeries((state[:, 2] for state in _run_shifted(chain, session)), shape)[
            steps
        ]
        for name, chain in session.chains.items()
        if hub.has_acceleration(chain)  # a state of its model
    }
    traces = _trace(session, "acceleration", steps, estimates)
    force = hub.OnePassSeries(rotate_force(session.signals, session.sensors), shape)[steps]
    felt = make_pair(session.record.time_at(steps), force + np.array(session.sensors.gravity))
    return replace(traces, imu=felt)


def _trace_bias(session: Session) -> Traces:
    record, simulated = session.record, session.record.gnss == "simulated"
    simulate = partial(simulate_true_bias, session.config, session.sensors, record.steps, 0)
    lines: dict[str, Pair] = {}
    errors: dict[str, Line] = {}
    for name, chain in session.chains.items():
        pieces = (state[:, 3] for state in _run_shifted(chain, session))
        if simulated:
            both = zip(pieces, simulate(), strict=True)
            pieces = (np.column_stack([bias, bias[:, 0] - true[:, 0]]) for bias, true in both)
        made = _make_lines(record, pieces, record.steps - hub.lag_of(chain))
        lines[name], errors[name] = (made[0], made[1]), made[-1]
    shown = find_distinct({name: x[0][1] for name, (x, _) in lines.items()})
    truth = None
    if lines and simulated:
        x, y = _make_lines(record, simulate(), record.steps)
        truth = x, y
    return Traces(
        (record.begin, record.end),
        {name: lines[name] for name in shown},
        {name: errors[name] for name in shown if simulated},
        truth=truth,
    )


def _make_lines(record: ReplayRecord, pieces: Iterable[Array], count: int) -> list[Line]:
    """Return a line per column of a series of `count` steps, in pieces of shape (n, columns)."""
    envelopes: list[Envelope] = []
    for piece in pieces:
        points = max(int(POINTS * count / record.steps), 8)
        envelopes = envelopes or [Envelope(count, points) for _ in piece.T]
        for envelope, values in zip(envelopes, piece.T, strict=True):
            envelope.add(values)
    found = (envelope.points() for envelope in envelopes)
    return [[(record.begin + record.step * steps, values)] for steps, values in found]


def _run_shifted(chain: hub.Chain, session: Session) -> Iterator[Array]:
    """Yield a filter's states, in NED, m, m/s and m/s^2, in pieces of shape (n, 4, 2).

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
