"""Puts a recorded structure in the place of a simulated truth, and compares estimates with it.

Sensors measure the columns at their places, and estimates are compared with the columns that are
there. What no column holds is NaN.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from owtsweep.errors import require
from owtsweep.evaluation.signals import scatter
from owtsweep.io.reading import expand_home
from owtsweep.structures.bernoulli import PlaneBeam
from owtsweep.studies.tower.contract import Estimates, Kind
from owtsweep.studies.tower.recorded import KINDS, NEAR, Recorded, RecordedStructure, read_record
from owtsweep.studies.tower.truth import Motion


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
    record = read_record(expand_home(str(recorded.file)), recorded.list_names())
    require(
        abs(record.step - step) <= 1e-6 * step,
        f"record.rate: {1.0 / step:g} Hz, but {record.path} has a row every {record.step:g} s; "
        f"set record.rate={1.0 / record.step:.6g}",
    )
    require(
        record.steps >= steps,
        f"record.duration: {steps * step:g} s, but {record.path} lasts "
        f"{record.steps * record.step:g} s; set record.duration={record.steps * record.step:g}",
    )
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
