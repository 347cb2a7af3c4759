"""Puts a recorded structure in the place of a simulated truth, and compares estimates with it.

A signal is called kind_height or kind_height_direction, e.g. `a_012`, `theta_3.5`, `F_24_fa`:

    x  displacement   v  velocity   a  acceleration   theta  rotation
    F  force on the structure at a cut, along x       M  moment on the structure at a cut

The height is in m above ground, the direction `fa` (taken where none is written) or `ss`.
Velocities are read and checked, but no scheme returns a velocity to compare with. Sensors measure
the signals at their places, and estimates are compared with those that are there. What no column
holds is NaN.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.evaluation.signals import scatter
from owtsweep.io.reading import expand_home
from owtsweep.motion.recorded import Signals, Wanted, read_signals
from owtsweep.structures.bernoulli import PlaneBeam
from owtsweep.studies.tower.contract import Estimates, Kind
from owtsweep.studies.tower.sections import Recorded
from owtsweep.studies.tower.truth import Motion

#: Kinds of signals with the dimension of their unit.
KINDS = {
    "x": "length",
    "v": "velocity",
    "a": "acceleration",
    "theta": "angle",
    "F": "force",
    "M": "moment",
}
NAME = re.compile(r"(theta|[xvaFM])_(\d+(?:\.\d+)?)(?:_(fa|ss))?")
#: Heights nearer than this are the same, m.
NEAR = 1e-6


def _find_dimension(signal: str) -> str | None:
    match = NAME.fullmatch(signal)
    return None if match is None else KINDS[match[1]]


WANTED = Wanted(
    "recorded.columns",
    _find_dimension,
    "a kind and a height in m above ground, and perhaps a direction: a_012, theta_3.5, F_175_fa",
)


class Signal(NamedTuple):
    """A signal: a key of `KINDS`, height above ground in m, "fa" or "ss", column and values."""

    kind: str
    height: float
    direction: str
    column: str
    values: Array


@dataclass(frozen=True)
class RecordedStructure:
    """A recorded structure: what its file holds, and its signals."""

    found: Signals
    signals: tuple[Signal, ...]

    @property
    def path(self) -> Path:
        """The file."""
        return self.found.path

    @property
    def steps(self) -> int:
        """The number of samples."""
        return len(self.found.time)

    @property
    def directions(self) -> tuple[str, ...]:
        """The directions that the record has columns of, "fa" before "ss"."""
        return tuple(sorted({signal.direction for signal in self.signals}))

    def find(self, kind: str, height: float, direction: str) -> Array | None:
        """Return a column's values, shape (steps,); None if there is no such column."""
        for signal in self.signals:
            same = signal.kind == kind and signal.direction == direction
            if same and abs(signal.height - height) <= NEAR:
                return signal.values
        return None

    def need(self, kind: str, height: float, direction: str) -> Array:
        """Return a column's values, shape (steps,).

        Raises
        ------
        InputError
            If there is no such column; the message lists the columns of the same kind.
        """
        values = self.find(kind, height, direction)
        if values is None:
            others = [s.column for s in self.signals if (s.kind, s.direction) == (kind, direction)]
            there = f"it has {', '.join(others)}" if others else f"it has none of kind {kind}"
            hint = (
                f"; of unknown meaning are {', '.join(self.found.unused[:8])}"
                if self.found.unused
                else ""
            )
            raise InputError(
                f"{self.path}: no column {kind}_{height:03g} of direction {direction} for the "
                f"sensor there; {there}{hint}; name the column by recorded.columns or choose other "
                "sensors"
            )
        return values


def read_record(recorded: Recorded) -> RecordedStructure:
    """Read and check a recorded structure: the file of the section `recorded`.

    Raises
    ------
    InputError
        As `read_signals`, or if no column is a signal, or two are the same quantity at the same
        place.
    """
    path = expand_home(str(recorded.file))
    found = read_signals(path, WANTED, recorded.columns)
    require(
        bool(found.values),
        f"{path}: no column has a name such as a_012 or F_175; it has "
        f"{', '.join(found.unused[:12])}; name the columns by recorded.columns",
    )
    places: dict[tuple[str, float, str], Signal] = {}
    for name, values in found.values.items():
        kind, height, direction = NAME.fullmatch(name).groups()  # type: ignore[union-attr]
        signal = Signal(kind, float(height), direction or "fa", found.columns[name], values)
        place = (kind, round(signal.height / NEAR) * NEAR, signal.direction)
        if place in places:
            raise InputError(
                f"{path}: the columns {places[place].column} and {signal.column} are the same "
                "quantity at the same height; leave one out"
            )
        places[place] = signal
    return RecordedStructure(found, tuple(places.values()))


def make_motions(record: RecordedStructure, cut: PlaneBeam) -> dict[str, Motion]:
    """Put a record in the place of a simulated truth.

    Parameters
    ----------
    record
        The record.
    cut
        The beam between the cuts; its lowest node is the ground, to which heights refer.

    Returns
    -------
    dict
        Direction -> motion, for the directions that the record has. What no column holds is NaN;
        the wave load is zero.

    Raises
    ------
    InputError
        If a column is at a height without a node, or a force or moment is not at a cut.
    """
    dof = len(cut.mass)
    ground = float(cut.heights[0])
    top = float(cut.heights[-1]) - ground
    motions = {
        direction: Motion(
            np.full((record.steps, dof), np.nan), np.full((record.steps, dof), np.nan),
            np.full((record.steps, 4), np.nan), np.zeros(record.steps),
        )
        for direction in record.directions
    }  # fmt: skip
    for signal in record.signals:
        motion, where = motions[signal.direction], f"{record.path}: column {signal.column}"
        if signal.kind in "FM":
            require(
                min(abs(signal.height), abs(signal.height - top)) <= NEAR,
                f"{where}: at {signal.height:g} m is no cut; forces and moments are known at the "
                f"cuts, 0 and {top:g} m above ground",
            )
            upper = abs(signal.height - top) <= NEAR
            motion.inputs[:, 2 * upper + (signal.kind == "M")] = signal.values
            continue
        node = cut.find_node(ground + signal.height, where)
        if signal.kind == "a":
            motion.acceleration[:, 2 * node] = signal.values
        elif signal.kind != "v":
            motion.displacement[:, 2 * node + (signal.kind == "theta")] = signal.values
    return motions


def load_motions(
    recorded: Recorded,
    cut: PlaneBeam,
    channels: Sequence[tuple[Kind, int]],
    *,
    steps: int,
    step: float,
) -> dict[str, Motion]:
    """Read a recorded structure, and put it in the place of a simulated truth.

    Parameters
    ----------
    recorded
        The section `recorded`, with a file.
    cut
        The beam between the cuts.
    channels
        Kinds and nodes of the sensors, for which the file must have columns.
    steps, step
        Number of samples that are taken from the file's beginning, and sampling interval (s).

    Returns
    -------
    dict
        As `make_motions`.

    Raises
    ------
    InputError
        If the file cannot be used, lacks a sensor's column, is too short or has another step.
    """
    record = read_record(recorded)
    record.found.require_record(1.0 / step, steps)
    for direction in record.directions:
        require_channels(record, cut, direction, channels)
    return {
        direction: Motion(
            motion.displacement[:steps], motion.acceleration[:steps], motion.inputs[:steps],
            motion.wave[:steps],
        )
        for direction, motion in make_motions(record, cut).items()
    }  # fmt: skip


def measure(
    motions: Mapping[str, Motion], estimates: Mapping[str, Estimates], cut: PlaneBeam, first: int
) -> dict[str, float]:
    """Compare the estimates of a record, by direction, from the sample `first` on.

    Returns
    -------
    dict
        Channel and direction, e.g. "F_024_fa" -> as `compare`;
        "displacement", the worst of the recorded displacements; and "base_moment", that of M0
        fore-aft where it is recorded.
    """
    found = {
        f"{name}_{direction}": error
        for direction, motion in motions.items()
        for name, error in compare(motion, estimates[direction], cut, first).items()
    }
    shifts = [error for name, error in found.items() if name.startswith("x_")]
    if shifts:
        found["displacement"] = max(shifts)
    if "M_000_fa" in found:
        found["base_moment"] = found["M_000_fa"]
    return found


def require_channels(
    record: RecordedStructure, cut: PlaneBeam, direction: str, channels: Sequence[tuple[Kind, int]]
) -> None:
    """Check that a record has the columns that sensors measure.

    `channels` are kinds and nodes of `cut`.

    Raises
    ------
    InputError
        If a column is missing, or a kind cannot be recorded.
    """
    for kind, node in channels:
        height = float(cut.heights[node] - cut.heights[0])
        require(
            kind in KINDS,
            f"recorded.file: a record holds no channel of kind {kind}; use sensors of kind x, "
            "theta and a",
        )
        record.need(kind, height, direction)


def compare(motion: Motion, estimates: Estimates, cut: PlaneBeam, first: int) -> dict[str, float]:
    """Compare estimates with what a record holds, from the sample `first` on.

    Returns
    -------
    dict
        Channel, e.g. "F_024" or "theta_012" -> standard deviation of the error over that of the
        recorded signal (`evaluation.signals.scatter`: a mean error does not count). Signals that
        are NaN or constant are left out.
    """
    heights = cut.heights - cut.heights[0]
    ends = heights[[0, 0, -1, -1]]
    pairs = [
        (f"{kind}_{height:03g}", motion.inputs[first:, i], estimates.inputs[first:, i])
        for i, (kind, height) in enumerate(zip("FMFM", ends, strict=True))
    ]
    for node, height in enumerate(heights):
        for part, kind in enumerate(("x", "theta")):
            at = 2 * node + part
            pairs.append((
                f"{kind}_{height:03g}", motion.displacement[first:, at],
                estimates.displacement[first:, at],
            ))  # fmt: skip
    return {
        name: float(scatter(truth, guess))
        for name, truth, guess in pairs
        if np.all(np.isfinite(truth)) and np.ptp(truth) > 0.0
    }
