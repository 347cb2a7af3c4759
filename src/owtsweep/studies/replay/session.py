"""Collect what a record's figures show (replicate 0), without keeping the whole record.

Schemes run piece by piece, and only the steps that a figure shows are kept.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

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


class SchemeFailed(Exception):
    """The error for a scheme that fails on a record; its attribute `name` is the scheme's name."""

    def __init__(self, name: str, cause: BaseException) -> None:
        self.name = name
        super().__init__(as_text(cause))


def run_scheme(
    config: ReplayConfig, scheme: Scheme, sensors: Sensors, signals: Signals, edges: list[int]
) -> Iterator[Trajectory]:
    """Run a scheme on one replicate of a record; yield its estimates from edge to edge.

    Raises SchemeFailed for any error in the scheme, so that the caller can go on with the others.
    """
    try:
        for (piece,) in estimate_pieces(config, scheme, sensors, [signals], edges):
            yield piece
    except (Exception, SystemExit) as error:
        raise SchemeFailed(scheme.name, error) from error
