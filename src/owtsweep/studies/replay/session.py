"""What figures show of a record and its schemes: pieces of replicate 0, not the whole of it.

All schemes go through the record side by side, piece by piece; kept are the steps that a figure
shows, and of the rest how large the errors grow and which schemes are the same line.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import as_text
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.contract import Scheme, Sensors
from owtsweep.studies.hub.schemes import resolve_all
from owtsweep.studies.replay.alike import Alike
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.estimating import Estimated, estimates
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.measuring import Signals, listen, pieces_of
from owtsweep.studies.replay.record import Record
from owtsweep.studies.replay.windows import Largest, windows

#: Quantity -> which columns of the state it is.
COLUMNS = {"position": slice(0, 2), "velocity": slice(2, 4)}


@dataclass(frozen=True)
class Session:
    """A record, what the sensors said in replicate 0, and what the schemes made of it.

    Attributes
    ----------
    windows
        Name of a window -> its steps.
    seen
        Name of a window -> scheme -> its estimates there.
    repeated
        "position" or "velocity" -> schemes whose line is that of a later one.
    bounds
        "position" or "velocity" -> scheme -> its largest error of x after a fifth of the record.
    failed
        Scheme -> why it has no estimates.
    """

    record: Record
    sensors: Sensors
    signals: Signals
    windows: Mapping[str, slice]
    seen: Mapping[str, Mapping[str, Estimated]]
    repeated: Mapping[str, frozenset[str]]
    bounds: Mapping[str, Mapping[str, float]]
    failed: Mapping[str, str]

    @property
    def names(self) -> list[str]:
        """The schemes that have estimates."""
        return list(next(iter(self.seen.values())))


def settled_from(record: Record) -> int:
    """The step from which on errors decide how far an axis reaches."""
    return record.steps // 5


def session(config: ReplayConfig, file: str) -> Session:
    """Run all schemes over replicate 0 of a record.

    Raises
    ------
    InputError
        If the file cannot be read.
    """
    record = load_record(config, file)
    sensors = sensing.sensors(config.sensors)
    signals = listen(config, sensors, record, 0)
    schemes = {scheme.name: scheme for scheme in resolve_all(config.schemes, config)}
    failed: dict[str, str] = {}
    while True:
        try:
            return _gathered(config, record, sensors, signals, schemes, failed)
        except SchemeFailed as error:
            failed[error.name] = str(error)
            del schemes[error.name]


class SchemeFailed(Exception):
    """A scheme, by name, has no estimates of this record."""

    def __init__(self, name: str, cause: BaseException) -> None:
        self.name = name
        super().__init__(as_text(cause))


def each(
    config: ReplayConfig, scheme: Scheme, sensors: Sensors, signals: Signals, edges: list[int]
) -> Iterator[Estimated]:
    """A scheme's estimates piece by piece.

    Raises
    ------
    SchemeFailed
        Whatever goes wrong in a scheme, perhaps a user's: the others have theirs.
    """
    try:
        for (piece,) in estimates(config, scheme, sensors, [signals], edges):
            yield piece
    except (Exception, SystemExit) as error:
        raise SchemeFailed(scheme.name, error) from error


def _gathered(
    config: ReplayConfig,
    record: Record,
    sensors: Sensors,
    signals: Signals,
    schemes: Mapping[str, Scheme],
    failed: Mapping[str, str],
) -> Session:
    edges = pieces_of(record.steps)
    largest = Largest(record)
    if record.position is not None:
        largest.add(record.position)
    elif schemes:
        first = next(iter(schemes.values()))
        for piece in each(config, first, sensors, signals, edges):
            largest.add(piece.state[:, :2])
    shown = windows(record, largest)
    kept: dict[str, dict[str, list[Estimated]]] = {
        window: {name: [] for name in schemes} for window in shown
    }
    alike = {quantity: Alike(list(schemes)) for quantity in COLUMNS}
    bounds = {quantity: dict.fromkeys(schemes, 0.0) for quantity in COLUMNS}
    runs = [each(config, scheme, sensors, signals, edges) for scheme in schemes.values()]
    begin, late = 0, settled_from(record)
    for pieces in zip(*runs, strict=True):
        end = begin + len(pieces[0].state)
        for window, steps in shown.items():
            own = slice(max(steps.start - begin, 0), max(steps.stop - begin, 0))
            for name, piece in zip(schemes, pieces, strict=True):
                kept[window][name].append(piece.part(own).copy())
        for quantity, columns in COLUMNS.items():
            alike[quantity].add([piece.state[:, columns] for piece in pieces])
            truth = getattr(record, quantity)
            if truth is None:
                continue
            after = slice(max(late - begin, 0), None)
            for name, piece in zip(schemes, pieces, strict=True):
                error = piece.state[after, columns.start] - truth[begin:end][after, 0]
                bounds[quantity][name] = largest_of(bounds[quantity][name], np.abs(error))
        begin = end
    return Session(
        record, sensors, signals, shown,
        {window: {n: Estimated.joined(p) for n, p in own.items()} for window, own in kept.items()},
        {quantity: found.repeated() for quantity, found in alike.items()},
        bounds, dict(failed),
    )  # fmt: skip


def largest_of(before: float, values: Array) -> float:
    """The largest of a number and of what is finite among some."""
    return float(np.max(values, initial=before, where=np.isfinite(values)))
