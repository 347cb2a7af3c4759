"""Collect the lines of the figures that show a record over time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from owtsweep.arrays import Array
from owtsweep.figures.lines import Envelope, Line, Pair, make_line, make_pair
from owtsweep.studies.replay.estimating import rotate_force
from owtsweep.studies.replay.session import COLUMNS, Session
from owtsweep.studies.replay.states import FilterStates


@dataclass(frozen=True)
class Traces:
    """The contents of a figure that shows one quantity over time.

    view: First and last time shown, in s.
    lines: Scheme -> the lines of its estimates of x and y. Schemes whose estimates equal those of a
        later scheme are left out.
    errors: Scheme -> the line of its errors of x; empty if the truth is unknown.
    bound: Largest absolute error of x after the first fifth of the record. It sets the range of the
        vertical axis of the panel of errors.
    truth, imu: Lines of x and y of the true quantity and of the IMU's measurements; None if not
        shown.
    fixes: Times of arrival of the fixes, shape (n,), and the fixes, shape (n, 2); None if not
        shown.
    deviations: Scheme -> times, and standard deviations of x that the scheme states.
    innovations: Scheme -> times, and innovations of x divided by the standard deviations that the
        scheme states for them.
    limits: Ranges of the vertical axes of the panels of x and y, shape (2, 2): rows x and y,
        columns lower and upper end. None if the ranges follow from the lines.
    """

    view: tuple[float, float]
    lines: Mapping[str, Pair]
    errors: Mapping[str, Line]
    bound: float
    truth: Pair | None = None
    imu: Pair | None = None
    fixes: tuple[Array, Array] | None = None
    deviations: Mapping[str, tuple[Array, Array]] = field(default_factory=dict)
    innovations: Mapping[str, tuple[Array, Array]] = field(default_factory=dict)
    limits: Array | None = None


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
    time = record.time_at(window)
    seen = {
        scheme: estimated
        for scheme, estimated in session.seen[name].items()
        if scheme not in session.repeated[quantity]
    }
    series: Array | None = getattr(record, quantity)
    truth = None if series is None else series[window]
    lines, errors, deviations = {}, {}, {}
    for scheme, estimated in seen.items():
        lines[scheme] = make_pair(time, estimated.state[:, columns])
        if truth is not None:
            errors[scheme] = make_line(time, estimated.state[:, columns.start] - truth[:, 0])
            deviations[scheme] = time, estimated.deviation[:, columns.start]
    innovations = {}
    for scheme, estimated in session.seen[name].items():
        scaled = estimated.scaled_innovation[:, 0]
        there = np.isfinite(scaled)
        if np.any(there):
            innovations[scheme] = time[there], scaled[there]
    return Traces(
        (float(time[0]), float(time[-1])),
        lines,
        errors,
        max((session.bounds[quantity][scheme] for scheme in seen), default=0.0),
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
    lines, errors, bound = {}, {}, 0.0
    for name, state in states.of.items():
        if state.acceleration is None or name in states.repeated["acceleration"]:
            continue
        lines[name] = make_pair(time, state.acceleration)
        bound = max(bound, state.acceleration_bound)
        if truth is not None:
            errors[name] = make_line(time, state.acceleration[:, 0] - truth[:, 0])
    measured = _take_force(session, window) + np.array(session.sensors.gravity)
    return Traces(
        (float(time[0]), float(time[-1])),
        lines,
        errors,
        bound,
        truth=None if truth is None else make_pair(time, truth),
        imu=make_pair(time, measured),
    )


def _take_force(session: Session, window: slice[int]) -> Array:
    """Return the measured specific force in NED coordinates, shape (n, 2) in m/s^2."""
    parts, begin = [], 0
    for piece in rotate_force(session.signals, session.sensors):
        parts.append(piece[max(window.start - begin, 0) : max(window.stop - begin, 0)])
        begin += len(piece)
        if begin >= window.stop:
            break
    return np.concatenate(parts)


def _trace_bias(session: Session, states: FilterStates) -> Traces:
    record = session.record
    filters = {n: state for n, state in states.of.items() if n not in states.repeated["bias"]}
    limits = np.array([state.bias_range for state in filters.values()] + [states.true_range])

    def to_line(envelope: Envelope) -> Line:
        steps, values = envelope.points()
        return [(record.begin + record.step * steps, values)]

    truth = states.true_bias
    return Traces(
        (record.begin, record.end),
        {name: (to_line(state.bias[0]), to_line(state.bias[1])) for name, state in filters.items()},
        {} if truth is None else {n: to_line(state.bias_error) for n, state in filters.items()},
        max((state.bias_bound for state in filters.values()), default=0.0),
        truth=None if truth is None else (to_line(truth[0]), to_line(truth[1])),
        limits=np.stack([limits[..., 0].min(axis=0), limits[..., 1].max(axis=0)], axis=1),
    )
