"""Collect the data that a record's figures show (replicate 0), without keeping the whole record.

All schemes run on the record together, piece by piece. Only the steps that a figure shows are kept,
and two results over all steps: the largest errors, and which schemes give equal estimates.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import as_text
from owtsweep.evaluation.trajectory import Trajectory, join
from owtsweep.studies.hub.public import Scheme, Sensors, make_sensors, resolve_all
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.estimating import estimate_pieces
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.record import ReplayRecord, Signals, cut_into_pieces, listen

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

    The part "whole" begins with the record and is at most `SPAN` s long. The shorter parts "zoom"
    and "acceleration" lie around the largest motion after `SETTLING` s. The positions, true or
    estimated, come in pieces of shape (n, 2) in m; NaN where unknown.
    """
    windows = {"whole": _select(record, record.begin, min(record.begin + SPAN, record.end))}
    for name, step in _find_largest_motion(record, positions).items():
        length = ZOOMS[name]
        start = max(record.begin + record.step * step - length / 2, record.begin)
        windows[name] = _select(record, start, min(start + length, record.end))
    return windows


def _find_largest_motion(record: ReplayRecord, positions: Iterable[Array]) -> dict[str, int]:
    """Find the step of the largest motion for each of the zoomed parts in `ZOOMS`: name -> step.

    A step is considered only if the zoomed part around it lies inside the record and begins after
    `SETTLING` s. If there is none, the middle step of the record is taken.
    """
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
    """Return the steps from `start` to `end` (s, on the file's clock), both included."""
    near = slice(
        max(int((start - record.begin) / record.step) - 2, 0),
        min(int((end - record.begin) / record.step) + 3, record.steps),
    )
    time = record.time_at(near)
    inside = near.start + np.flatnonzero((time >= start) & (time <= end))
    return slice(int(inside[0]), int(inside[-1]) + 1)


@dataclass(frozen=True)
class Session:
    """The data for a record's figures: the record, its measurements, and the schemes' estimates.

    record, sensors, signals: the record, the sensors' parameters, and the measurements in replicate
        0.
    windows: Name of a part of the record ("whole", "zoom" or "acceleration") -> the steps of this
        part.
    seen: Name of a part of the record -> scheme -> estimates in this part.
    repeated: "position" or "velocity" -> schemes whose estimates equal those of a later scheme.
    bounds: "position" or "velocity" -> scheme -> largest absolute error along x, after the first
        fifth of the record; 0 if the truth is unknown.
    failed: Scheme that failed -> the reason.
    """

    record: ReplayRecord
    sensors: Sensors
    signals: Signals
    windows: Mapping[str, slice[int]]
    seen: Mapping[str, Mapping[str, Trajectory]]
    repeated: Mapping[str, frozenset[str]]
    bounds: Mapping[str, Mapping[str, float]]
    failed: Mapping[str, str]

    @property
    def names(self) -> list[str]:
        """The names of the schemes that have estimates, without failed schemes."""
        return list(next(iter(self.seen.values())))


class Alike:
    """Finds which named series, that come piece by piece, are equal but for rounding errors."""

    def __init__(self, names: Iterable[str]) -> None:
        self._pairs = list(combinations(names, 2))

    def add(self, pieces: Mapping[str, Array]) -> None:
        self._pairs = [
            (one, other)
            for one, other in self._pairs
            if np.allclose(pieces[one], pieces[other], rtol=1e-9, atol=1e-12, equal_nan=True)
        ]

    def repeated(self) -> frozenset[str]:
        """Return the names of those series that are equal to a later series."""
        return frozenset(one for one, _ in self._pairs)


def skip_start(record: ReplayRecord) -> int:
    """Return the step after the first fifth of the record, until which estimates settle."""
    return record.steps // 5


def run_session(config: ReplayConfig, file: str) -> Session:
    """Run all schemes on replicate 0 of the record in a file, and collect the data for its figures.

    A scheme that fails is left out, and listed in the result's `failed`. Raise `InputError` if the
    file cannot be read.
    """
    record = load_record(config, file)
    sensors = make_sensors(config.sensors)
    signals = listen(config, sensors, record, 0)
    schemes = {scheme.name: scheme for scheme in resolve_all(config.schemes, config)}
    failed: dict[str, str] = {}
    while True:
        try:
            return _run_side_by_side(config, record, sensors, signals, schemes, failed)
        except SchemeFailed as error:
            failed[error.name] = str(error)
            del schemes[error.name]


class SchemeFailed(Exception):
    """The error for a scheme that fails on a record; its attribute `name` is the scheme's name."""

    def __init__(self, name: str, cause: BaseException) -> None:
        self.name = name
        super().__init__(as_text(cause))


def run_scheme(
    config: ReplayConfig, scheme: Scheme, sensors: Sensors, signals: Signals, edges: list[int]
) -> Iterator[Trajectory]:
    """Run a scheme on one replicate of a record; yield its estimates piece by piece.

    `edges` are the steps at which the pieces begin, and the number of steps. Raise `SchemeFailed`
    for any error in the scheme, so that the caller can continue with the other schemes.
    """
    try:
        for (piece,) in estimate_pieces(config, scheme, sensors, [signals], edges):
            yield piece
    except (Exception, SystemExit) as error:
        raise SchemeFailed(scheme.name, error) from error


def _run_side_by_side(
    config: ReplayConfig,
    record: ReplayRecord,
    sensors: Sensors,
    signals: Signals,
    schemes: Mapping[str, Scheme],
    failed: Mapping[str, str],
) -> Session:
    edges = cut_into_pieces(record.steps)
    truth = record.position
    positions: Iterable[Array] = ()
    if truth is not None:
        positions = (truth[first:last] for first, last in pairwise(edges))
    elif schemes:
        any_scheme = next(iter(schemes.values()))
        run = run_scheme(config, any_scheme, sensors, signals, edges)
        positions = (piece.state[:, :2] for piece in run)
    windows = choose_windows(record, positions)
    kept: dict[str, dict[str, list[Trajectory]]] = {
        window: {name: [] for name in schemes} for window in windows
    }
    alike = {quantity: Alike(schemes) for quantity in COLUMNS}
    bounds = {quantity: dict.fromkeys(schemes, 0.0) for quantity in COLUMNS}
    runs = [run_scheme(config, scheme, sensors, signals, edges) for scheme in schemes.values()]
    begin, late = 0, skip_start(record)
    for estimates in zip(*runs, strict=True):
        pieces = dict(zip(schemes, estimates, strict=True))
        end = begin + len(estimates[0].state)
        for window, steps in windows.items():
            inside = slice(max(steps.start - begin, 0), max(steps.stop - begin, 0))
            for name, piece in pieces.items():
                kept[window][name].append(piece.part(inside).copy())
        for quantity, columns in COLUMNS.items():
            alike[quantity].add({name: piece.state[:, columns] for name, piece in pieces.items()})
            series = getattr(record, quantity)
            if series is None:
                continue
            after = slice(max(late - begin, 0), None)
            for name, piece in pieces.items():
                error = piece.state[after, columns.start] - series[begin:end][after, 0]
                bounds[quantity][name] = raise_bound(bounds[quantity][name], np.abs(error))
        begin = end
    seen = {
        window: {name: join(parts) for name, parts in of_window.items()}
        for window, of_window in kept.items()
    }
    repeated = {quantity: pairs.repeated() for quantity, pairs in alike.items()}
    return Session(record, sensors, signals, windows, seen, repeated, bounds, dict(failed))


def raise_bound(bound: float, values: Array) -> float:
    """Return the greatest of `bound` and the finite values in `values`."""
    return float(np.max(values, initial=bound, where=np.isfinite(values)))
