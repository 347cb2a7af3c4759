"""The hub study as a declaration, one for each world: from motion to schemes' errors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Reading
from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.results.conditions import Value
from owtsweep.studies.base.declaration import (
    AnyDeclaration,
    Batch,
    Declaration,
    Means,
    Quantity,
    Shown,
    Stated,
)
from owtsweep.studies.base.schemes import NotFinite, Part
from owtsweep.studies.hub.batch import know, run_batch, uses_kernels
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import SCHEMES, Known, Scheme
from owtsweep.studies.hub.measures import from_trajectories
from owtsweep.studies.hub.records import Records, count_records_per_block, make_records_at
from owtsweep.studies.hub.sensors import Measured, observe
from owtsweep.studies.hub.worlds import (
    WORLDS,
    World,
    find_amplitude,
    list_content,
    list_untold,
)

Cell = Mapping[str, Value]
UNITS = {
    "position": "m, north and east",
    "velocity": "m/s, north and east",
    "specific_force": "m/s^2, in the frame of the IMU",
    "fixes": "m, north and east, of sensors.gnss.delay seconds before",
}


class Record(NamedTuple):
    """One record whose motion has no amplitude yet.

    truth: true x, y (m) and v_x, v_y (m/s), shape (steps, 4).
    motion, noise: the parts of the measurements that motion and noise contribute.
    """

    records: Records
    truth: Array
    motion: Measured
    noise: Measured


def _measure(config: HubConfig, cell: Cell, records: Records) -> Record:
    """Return what sensors say; fixes that are lost with the noise are lost with the motion."""
    (motion,), (noise,), direction = records.motion, records.noise, records.direction
    observed = observe(motion, direction, records.sensors)
    observed.fixes[np.isnan(noise.fixes)] = np.nan
    truth = [np.outer(series, direction) for series in (motion.position, motion.velocity)]
    return Record(records, np.concatenate(truth, axis=1), observed, noise)


def _inform(config: HubConfig, cell: Cell, record: Record) -> dict[str, Part[Known, Measured]]:
    """Return the whole record, or in a cell without an amplitude motion and noise apart."""
    known, motion, noise = know(config, cell), record.motion, record.noise
    if known.amplitude is None:
        return {"motion": Part(known, motion), "noise": Part(known, noise)}
    return {"whole": Part(known, motion.add_noise(known.amplitude, noise))}


def _score(
    config: HubConfig,
    cell: Cell,
    record: Record,
    parts: Mapping[str, Part[Known, Measured]],
    estimates: Mapping[str, Trajectory],
) -> Means:
    amplitude = find_amplitude(config, cell)
    settled = config.measures.find_settled(record.records.sensors.step)
    if amplitude is None:
        means = from_trajectories(estimates["motion"], estimates["noise"], record.truth, settled)
    else:
        truth, extremes = amplitude * record.truth, config.measures.extremes
        means = from_trajectories(None, estimates["whole"], truth, settled, extremes=extremes)
    if not np.all(np.isfinite(means.products)):
        raise NotFinite("squares of the errors are too large, or no numbers")
    return means


def superposes(config: HubConfig, scheme: Scheme) -> bool:
    """Return whether a scheme runs once for all amplitudes, motion and noise apart.

    A scheme with `knows_motion` does not, for it has other gains at each; nor does one with a
    kernel of its own.
    """
    alone = scheme.knows_motion or scheme.batched == "own"
    return config.evaluation == "superposed" and scheme.linear and not alone


def _show(config: HubConfig, cell: Cell, record: Record) -> Shown:
    (part,) = _inform(config, cell, record).values()
    step, measured = record.records.sensors.step, part.measured
    time = step * np.arange(len(record.truth))
    truth = (part.known.amplitude or 0.0) * record.truth
    of_fixes = time[:: record.records.sensors.fix_interval][: len(measured.fixes)]
    return Shown(
        time,
        config.measures.find_settled(step),
        {"position": truth[:, :2], "velocity": truth[:, 2:]},
        {
            "specific_force": Reading(time, measured.specific_force),
            "fixes": Reading(of_fixes, measured.fixes),
        },
        UNITS,
    )


def _state(record: Record, estimates: Mapping[str, Trajectory]) -> Stated:
    (found,) = estimates.values()
    P = found.covariance
    stated = {} if P is None else {"position": P[:, :2, :2], "velocity": P[:, 2:, 2:]}
    return Stated({"position": found.state[:, :2], "velocity": found.state[:, 2:]}, stated, 0.0)


def _declare(world: World) -> AnyDeclaration:
    return Declaration(
        axes=world,
        schemes=SCHEMES,
        list_content=list_content,
        most_records=count_records_per_block,
        make_truth=lambda config, cell, replicate: make_records_at(config, cell, [replicate]),
        measure=_measure,
        inform=_inform,
        tell=Scheme.tell,
        score=_score,
        estimates={"state": Quantity((4,)), "covariance": Quantity((4, 4), optional=True)},
        count_samples=lambda record: len(record.truth),
        show=_show,
        state=_state,
        superposes=superposes,
        batch=Batch(uses_kernels, make_records_at, run_batch),
        list_untold=list_untold,
    )


DECLARATIONS = {world.name: _declare(world) for world in WORLDS.values()}


def find_declaration(config: HubConfig) -> AnyDeclaration:
    """Return the declaration of the world that a configuration chooses."""
    return DECLARATIONS[config.motion.kind]
