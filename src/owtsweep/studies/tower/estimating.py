"""Shows one record of the tower study: motion, loads, channels and the schemes' estimates."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import EstimatedRecord, Reading
from owtsweep.results.conditions import find_only_cell
from owtsweep.studies.tower.blocks import prepare
from owtsweep.studies.tower.case import list_channels, make_case, measure, name_channel
from owtsweep.studies.tower.conditions import CONDITIONS
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contract import INPUTS, Unable
from owtsweep.studies.tower.schemes import resolve_all
from owtsweep.studies.tower.sight import require_sight

UNITS = {
    "displacement": "m and rad, translation and rotation of each node of the cut structure",
    "inputs": f"N and N m, {', '.join(INPUTS)} on the cut structure",
    "wave": "N/m at sea level",
    "x": "m",
    "theta": "rad",
    "a": "m/s^2",
    "strain": "of the outer fibre, no unit",
    "gnss": "m",
}


def estimate_record(config: TowerConfig, replicate: int) -> EstimatedRecord:
    """Make a record, run all schemes on both its directions, and return all of it.

    No scheme of this study states a covariance. Names of quantities and signals end with the
    direction, "_fa" or "_ss".

    Raises
    ------
    InputError
        If the grid has several cells, or the record cannot be made.
    """
    require_sight(config)
    cell = find_only_cell({c.name: getattr(config.grid, c.name) for c in CONDITIONS})
    noise, soil_factor = float(cell["noise"]), float(cell["soil_factor"])
    case = make_case(config, replicate)
    time = np.arange(config.record.steps) / config.record.rate
    channels = {d: list_channels(config, case, d, noise) for d in case.motion}
    measured = {d: measure(config, case, d, channels[d]) for d in case.motion}
    estimates: dict[str, dict[str, Array]] = {}
    waits, failures = {}, {}
    for scheme in resolve_all(config.schemes):
        # A scheme that does not know the soil is told the right one.
        factor = soil_factor if scheme.knows_soil else 1.0
        found: dict[str, Array] = {}
        try:
            for d, signals in measured.items():
                given = prepare(config, case, d, factor, channels[d], scheme).run(signals)
                found[f"displacement_{d}"], found[f"inputs_{d}"] = given.displacement, given.inputs
                if given.wave is not None:
                    found[f"wave_{d}"] = given.wave
        except Unable as reason:
            failures[scheme.name] = str(reason)
            continue
        estimates[scheme.name], waits[scheme.name] = found, given.wait
    truth = {
        f"{name}_{d}": getattr(motion, name)
        for d, motion in case.motion.items()
        for name in ("displacement", "inputs", "wave")
    }
    named = {
        f"{name_channel(case, place)}_{d}": Reading(time, measured[d][:, i])
        for d in case.motion
        for i, place in enumerate(case.places)
    }
    return EstimatedRecord(
        study=config.study,
        tuning=config.tuning_name,
        conditions=cell,
        replicate=replicate,
        settled=config.record.settled,
        time=time,
        truth=truth,
        measurements=named,
        estimates=estimates,
        covariances={name: {} for name in estimates},
        waits=waits,
        units={name: UNITS[name.partition("_")[0]] for name in [*truth, *named]},
        failures=failures,
    )
