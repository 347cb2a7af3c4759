"""Shows one record of the floater study: motion, measurements and the schemes' estimates."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import EstimatedRecord, Reading
from owtsweep.results.conditions import find_only_cell
from owtsweep.studies.floater.believed import make_setting
from owtsweep.studies.floater.case import list_cases
from owtsweep.studies.floater.config import FloaterConfig
from owtsweep.studies.floater.contract import DOF, Estimates, Unable
from owtsweep.studies.floater.measuring import measure
from owtsweep.studies.floater.schemes import resolve
from owtsweep.studies.floater.sections import AXES
from owtsweep.studies.floater.truth import make_truth

#: Signals of `contract.Measured` -> their units.
SIGNALS = {
    "position": f"m and rad: {', '.join(DOF)}",
    "age": "s, of the position reported",
    "acceleration": "m/s^2 and rad/s^2",
    "rate": "rad/s",
    "specific_force": "m/s^2, in the frame of the body",
}
UNITS = {**SIGNALS, "velocity": "m/s and rad/s, derivatives of the position"}


def estimate_record(config: FloaterConfig, replicate: int) -> EstimatedRecord:
    """Make a record, run all schemes on it, and return all of it.

    Covariances are those of each degree of freedom alone.

    Raises
    ------
    InputError
        If the grid has several cells, or the record cannot be made.
    """
    grid = {axis: getattr(config.grid, axis) for axis in AXES}
    cell = find_only_cell({axis: values for axis, values in grid.items() if values is not None})
    (conditions,) = list_cases(config)
    motion = make_truth(config, replicate, conditions.roll)
    measured = measure(config, motion, conditions, replicate)
    setting = make_setting(config, motion, conditions)
    truth, time = motion.truth, motion.truth.step * np.arange(len(motion.truth.position))
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
            for name in ("position", "velocity", "acceleration", "rate", "specific_force")
        },
        measurements={
            name: Reading(time, signal)
            for name in SIGNALS
            if (signal := getattr(measured, name)) is not None
        },
        estimates={
            name: {"position": given.position, "velocity": given.velocity}
            for name, given in found.items()
        },
        covariances={name: _spread(given, len(time)) for name, given in found.items()},
        waits={name: given.wait for name, given in found.items()},
        units=UNITS,
        failures=failures,
    )


def _spread(estimates: Estimates, steps: int) -> dict[str, Array]:
    """Return covariances of position and velocity, shape (steps, 6, 6), diagonal."""
    if estimates.covariance is None:
        return {}
    spread: dict[str, Array] = {}
    for i, name in enumerate(("position", "velocity")):
        variance = estimates.covariance[:, :, i, i]
        spread[name] = np.broadcast_to(
            variance[:, :, None] * np.eye(len(DOF)), (steps, len(DOF), len(DOF))
        )
    return spread
