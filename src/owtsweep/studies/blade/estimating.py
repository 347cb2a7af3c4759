"""Shows one record of the blade study: motion, measurements and the schemes' estimates."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import EstimatedRecord, Reading
from owtsweep.results.conditions import find_only_cell
from owtsweep.studies.blade.case import list_cases
from owtsweep.studies.blade.cases import make_cases
from owtsweep.studies.blade.config import BladeConfig
from owtsweep.studies.blade.contract import Estimates, Unable
from owtsweep.studies.blade.doubts import warn_of_doubts
from owtsweep.studies.blade.schemes import resolve
from owtsweep.studies.blade.sections import AXES

UNITS = {
    "root": "m",
    "root_velocity": "m/s",
    "rotation": "turns vectors of the body into the frame at rest; its error in the body, rad",
    "unit": "m",
    "unit_velocity": "m/s",
    "rate": "rad/s, in the frame of the body",
    "specific_force": "m/s^2, in the frame of the body",
    "fixes": "m, of each antenna",
    "prisms": "m, of each prism, by the clock of the total stations",
}


def estimate_record(config: BladeConfig, replicate: int) -> EstimatedRecord:
    """Make a record, run all schemes on it, and return all of it.

    The frame is x along the blade from root to tip, z up.

    Raises
    ------
    InputError
        If the grid has several cells.
    """
    grid = {axis: getattr(config.grid, axis) for axis in AXES}
    cell = find_only_cell({axis: values for axis, values in grid.items() if values is not None})
    warn_of_doubts(config)
    (conditions,) = list_cases(config)
    (case,) = make_cases(config, conditions, [replicate])
    truth, measured = case.truth, case.measured
    setting = case.tell(config, conditions)
    time = truth.step * np.arange(len(truth.root))
    found: dict[str, Estimates] = {}
    failures = {}
    for name in config.schemes:
        try:
            found[name] = resolve(name).prepare(setting).run(measured)
        except Unable as reason:
            failures[name] = str(reason)
    return EstimatedRecord(
        study=config.study,
        tuning=config.tuning_name,
        conditions=cell,
        replicate=replicate,
        settled=config.record.settled,
        time=time,
        truth={
            name: getattr(truth, name)
            for name in (
                "root", "root_velocity", "rotation", "unit", "unit_velocity", "rate",
                "specific_force",
            )
        },
        measurements={
            "specific_force": Reading(time, measured.specific_force),
            "rate": Reading(time, measured.rate),
            "fixes": Reading(time[measured.due], measured.fixes[measured.due]),
            "prisms": Reading(measured.prism_times, measured.prisms),
        },
        estimates={
            name: {
                "root": given.root,
                "root_velocity": given.root_velocity,
                "rotation": given.rotation,
            }
            for name, given in found.items()
        },
        covariances={name: _list_covariances(given) for name, given in found.items()},
        waits={name: given.wait for name, given in found.items()},
        units=UNITS,
        failures=failures,
        at_rest={"root": case.geometry.root, "unit": case.geometry.unit},
    )  # fmt: skip


def _list_covariances(estimates: Estimates) -> dict[str, Array]:
    """Return the covariances that a scheme states, by quantity."""
    stated = {"root": estimates.root_covariance, "rotation": estimates.attitude_covariance}
    return {name: P for name, P in stated.items() if P is not None}
