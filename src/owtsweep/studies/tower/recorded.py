"""Puts a recorded structure in the place of a simulated truth, and compares estimates with it.

A signal is called kind_height or kind_height_direction, e.g. `a_012`, `theta_3.5`, `F_24_ss`: x is
displacement, v velocity, a acceleration, theta rotation, F and M force and moment at a cut. The
height is in m above ground, the direction `fa` (taken where none is written) or `ss`. What no
column holds is NaN. No scheme returns a velocity to compare with.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from owtsweep.errors import require
from owtsweep.evaluation.signals import scatter
from owtsweep.io.reading import expand_home
from owtsweep.motion.recorded import Signals, Wanted, read_signals
from owtsweep.structures.bernoulli import NEAR, PlaneBeam
from owtsweep.studies.tower import measuring
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contract import Estimates
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


WANTED = Wanted(
    "recorded.columns",
    lambda signal: KINDS[match[1]] if (match := NAME.fullmatch(signal)) else None,
    "a kind and a height in m above ground, and perhaps a direction: a_012, theta_3.5, F_175_fa",
)


class Place(NamedTuple):
    """What a signal is: a key of `KINDS`, height above ground in m, "fa" or "ss"."""

    kind: str
    height: float
    direction: str


class RecordedStructure(NamedTuple):
    """A recorded structure: its file's signals, and the name of the signal of each place."""

    found: Signals
    names: dict[Place, str]

    @property
    def directions(self) -> list[str]:
        """The directions that the record has columns of, "fa" before "ss"."""
        return sorted({place.direction for place in self.names})


def read_record(recorded: Recorded) -> RecordedStructure:
    """Read and check a recorded structure: the file of the section `recorded`.

    Raises InputError as `read_signals`, or if no column is a signal, or two are the same quantity.
    """
    path = expand_home(str(recorded.file))
    found = read_signals(path, WANTED, recorded.columns)
    require(
        bool(found.values),
        f"{path}: no column has a name such as a_012 or F_175; it has "
        f"{', '.join(found.unused[:12])}; name the columns by recorded.columns",
    )
    names: dict[Place, str] = {}
    for name in found.values:
        kind, height, direction = NAME.fullmatch(name).groups()  # type: ignore[union-attr]
        place = Place(kind, round(float(height) / NEAR) * NEAR, direction or "fa")
        require(
            place not in names,
            f"{path}: the columns {found.columns.get(names.get(place, ''))} and "
            f"{found.columns[name]} are the same quantity at the same height; leave one out",
        )
        names[place] = name
    return RecordedStructure(found, names)


def make_motions(
    record: RecordedStructure, cut: PlaneBeam, steps: int | None = None
) -> dict[str, Motion]:
    """Put the first `steps` samples of a record (None: all) in the place of a simulated truth.

    Heights refer to the ground, the lowest node of `cut`, the beam between the cuts.

    Returns: direction -> motion; what no column holds is NaN, and the wave load is zero.
    Raises InputError if a column is at a height without a node, or a load is not at a cut.
    """
    steps = len(record.found.time) if steps is None else steps
    shape = (steps, len(cut.mass))
    ground = float(cut.heights[0])
    top = float(cut.heights[-1]) - ground
    motions = {
        direction: Motion(
            np.full(shape, np.nan), np.full(shape, np.nan), np.full((steps, 4), np.nan),
            np.zeros(steps),
        )
        for direction in record.directions
    }  # fmt: skip
    for (kind, height, direction), name in record.names.items():
        motion, values = motions[direction], record.found.values[name][:steps]
        where = f"{record.found.path}: column {record.found.columns[name]}"
        if kind in "FM":
            upper = abs(height - top) <= NEAR
            require(
                upper or height <= NEAR,
                f"{where}: at {height:g} m is no cut; forces and moments are known at the cuts, 0 "
                f"and {top:g} m above ground",
            )
            motion.inputs[:, 2 * upper + (kind == "M")] = values
            continue
        node = cut.find_node(ground + height, where)
        if kind == "a":
            motion.acceleration[:, 2 * node] = values
        elif kind != "v":
            motion.displacement[:, 2 * node + (kind == "theta")] = values
    return motions


def load_motions(
    config: TowerConfig, cut: PlaneBeam, channels: Sequence[measuring.Place]
) -> dict[str, Motion]:
    """Read a recorded structure, and put its beginning in the place of a simulated truth.

    The section `recorded` has a file, `cut` is the beam between the cuts, and the file must have a
    column for each of the `channels`.

    Raises InputError as `make_motions`, or if the file lacks a column, is too short, or has another
        step.
    """
    record = read_record(config.recorded)
    record.found.require_record(config.record.rate, config.record.steps)
    for direction in record.directions:
        require_channels(record, cut, direction, channels)
    return make_motions(record, cut, config.record.steps)


def require_channels(
    record: RecordedStructure, cut: PlaneBeam, direction: str, channels: Sequence[measuring.Place]
) -> None:
    """Raise `InputError` if a record lacks a column for a sensor at a node of `cut`."""
    for kind, node, _ in channels:
        require(
            kind in KINDS,
            f"recorded.file: a record holds no channel of kind {kind}; use sensors of kind x, "
            "theta and a",
        )
        height = float(cut.heights[node] - cut.heights[0])
        alike = {
            place.height: record.found.columns[name]
            for place, name in record.names.items()
            if (place.kind, place.direction) == (kind, direction)
        }
        there = f"it has {', '.join(alike.values())}" if alike else f"it has none of kind {kind}"
        unused = ", ".join(record.found.unused[:8])
        hint = f"; of unknown meaning are {unused}" if unused else ""
        require(
            any(abs(other - height) <= NEAR for other in alike),
            f"{record.found.path}: no column {kind}_{height:03g} of direction {direction} for the "
            f"sensor there; {there}{hint}; name the column by recorded.columns or choose other "
            "sensors",
        )


def measure(
    motions: Mapping[str, Motion], estimates: Mapping[str, Estimates], cut: PlaneBeam, first: int
) -> dict[str, float]:
    """Compare the estimates of a record, by direction, from the sample `first` on.

    Returns: channel and direction, e.g. "F_024_fa" -> standard deviation of the error over that of
        the signal (`evaluation.signals.scatter`), without signals that are NaN or constant;
        "displacement", the worst of the recorded ones; and "base_moment", that of M0 fore-aft.
    """
    heights = cut.heights - cut.heights[0]
    names = [f"{kind}_{height:03g}" for height in heights[[0, -1]] for kind in "FM"]
    names += [f"{kind}_{height:03g}" for height in heights for kind in ("x", "theta")]
    found: dict[str, float] = {}
    for direction, motion in motions.items():
        guess = estimates[direction]
        truths = (*motion.inputs[first:].T, *motion.displacement[first:].T)
        guesses = (*guess.inputs[first:].T, *guess.displacement[first:].T)
        for name, own, guessed in zip(names, truths, guesses, strict=True):
            if np.all(np.isfinite(own)) and np.ptp(own) > 0.0:
                found[f"{name}_{direction}"] = float(scatter(own, guessed))
    shifts = [error for name, error in found.items() if name.startswith("x_")]
    if shifts:
        found["displacement"] = max(shifts)
    if "M_000_fa" in found:
        found["base_moment"] = found["M_000_fa"]
    return found
