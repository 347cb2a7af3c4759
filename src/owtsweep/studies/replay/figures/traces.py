"""Collect the lines of the figures that show a record over time."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from owtsweep.arrays import Array
from owtsweep.figures.lines import Envelope, Line, Pair, make_line, make_pair
from owtsweep.studies.replay.estimating import rotate_force
from owtsweep.studies.replay.session import COLUMNS, FilterStates, Session, find_repeated


@dataclass(frozen=True)
class Traces:
    """The contents of a figure that shows one quantity over time; what is None is not shown.

    view: First and last time shown, in s.
    lines: Scheme -> the lines of its estimates of x and y, without schemes that equal a later one.
    errors: Scheme -> the line of its errors of x; empty if the truth is unknown.
    truth, imu: Lines of x and y of the true quantity and of the IMU's measurements.
    fixes: Times of arrival of the fixes, shape (n,), and the fixes, shape (n, 2).
    deviations: Scheme -> times, and standard deviations of x that the scheme states.
    innovations: Scheme -> times, and innovations of x over their stated standard deviations.
    """

    view: tuple[float, float]
    lines: Mapping[str, Pair]
    errors: Mapping[str, Line]
    truth: Pair | None = None
    imu: Pair | None = None
    fixes: tuple[Array, Array] | None = None
    deviations: Mapping[str, tuple[Array, Array]] = field(default_factory=dict)
    innovations: Mapping[str, tuple[Array, Array]] = field(default_factory=dict)

    def find_range(self, lines: Iterable[Line]) -> tuple[float, float]:
        """Return the least and the greatest value of lines after the first fifth of the view."""
        start = self.view[0] + 0.2 * (self.view[1] - self.view[0])
        late = [values[time >= start] for line in lines for time, values in line]
        values = np.concatenate([*late, np.empty(0)])
        return (float(values.min()), float(values.max())) if len(values) else (0.0, 0.0)


def collect_traces(
    session: Session, states: Callable[[], FilterStates], quantity: str, *, zoom: bool
) -> Traces:
    """Collect the lines of a figure that shows one quantity over time; arguments as of `draw`.

    `zoom` applies to position and velocity; the acceleration is always zoomed in, the bias never.
    """
    if quantity == "bias":
        return _trace_bias(session, states())
    if quantity == "acceleration":
        return _trace_acceleration(session, states())
    return _trace_state(session, quantity, "zoom" if zoom else "whole")


def _trace_state(session: Session, quantity: str, name: str) -> Traces:
    record, window, columns = session.record, session.windows[name], COLUMNS[quantity]
    time, seen = record.time_at(window), session.seen[name]
    same = find_repeated({scheme: each.state[:, columns] for scheme, each in seen.items()})
    series: Array | None = getattr(record, quantity)
    truth = None if series is None else series[window]
    lines, errors, deviations, innovations = {}, {}, {}, {}
    for scheme, estimated in seen.items():
        scaled = estimated.scaled_innovation[:, 0]
        there = np.isfinite(scaled)
        if np.any(there):
            innovations[scheme] = time[there], scaled[there]
        if scheme in same:
            continue
        lines[scheme] = make_pair(time, estimated.state[:, columns])
        if truth is not None:
            errors[scheme] = make_line(time, estimated.state[:, columns.start] - truth[:, 0])
            deviations[scheme] = time, estimated.deviation[:, columns.start]
    return Traces(
        (float(time[0]), float(time[-1])),
        lines,
        errors,
        truth=None if truth is None else make_pair(time, truth),
        fixes=_take_fixes(session, window) if quantity == "position" else None,
        deviations=deviations,
        innovations=innovations,
    )


def _take_fixes(session: Session, window: slice[int]) -> tuple[Array, Array]:
    M = session.sensors.fix_interval
    number = slice(-(-window.start // M), -(-window.stop // M))
    due = M * np.arange(number.start, number.stop)
    return session.record.time_at(window)[due - window.start], session.signals.fixes[number]


def _trace_acceleration(session: Session, states: FilterStates) -> Traces:
    record, window = session.record, session.windows["acceleration"]
    time = record.time_at(window)
    truth = None if record.acceleration is None else record.acceleration[window]
    known = {name: s.acceleration for name, s in states.of.items() if s.acceleration is not None}
    same = find_repeated(known)
    shown = {name: values for name, values in known.items() if name not in same}
    measured = _take_force(session, window) + np.array(session.sensors.gravity)
    return Traces(
        (float(time[0]), float(time[-1])),
        {name: make_pair(time, values) for name, values in shown.items()},
        {}
        if truth is None
        else {name: make_line(time, each[:, 0] - truth[:, 0]) for name, each in shown.items()},
        truth=None if truth is None else make_pair(time, truth),
        imu=make_pair(time, measured),
    )


def _take_force(session: Session, window: slice[int]) -> Array:
    parts, begin = [], 0
    for piece in rotate_force(session.signals, session.sensors):
        parts.append(piece[max(window.start - begin, 0) : max(window.stop - begin, 0)])
        begin += len(piece)
        if begin >= window.stop:
            break
    return np.concatenate(parts)


def _trace_bias(session: Session, states: FilterStates) -> Traces:
    record = session.record

    def to_line(envelope: Envelope) -> Line:
        steps, values = envelope.points()
        return [(record.begin + record.step * steps, values)]

    lines = {n: (to_line(s.bias[0]), to_line(s.bias[1])) for n, s in states.of.items()}
    same = find_repeated({name: pair[0][0][1] for name, pair in lines.items()})
    truth = states.true_bias
    return Traces(
        (record.begin, record.end),
        {name: pair for name, pair in lines.items() if name not in same},
        {}
        if truth is None
        else {n: to_line(s.bias_error) for n, s in states.of.items() if n not in same},
        truth=None if truth is None else (to_line(truth[0]), to_line(truth[1])),
    )
