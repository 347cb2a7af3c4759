"""Shows one record of the hub study: motion, measurements and the schemes' estimates."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import as_text
from owtsweep.evaluation.estimate import EstimatedRecord, Reading
from owtsweep.evaluation.loop import run_estimator
from owtsweep.results.conditions import find_only_cell
from owtsweep.studies.hub.blocks import start, tell
from owtsweep.studies.hub.conditions import find_world, get_grid
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.known import Known
from owtsweep.studies.hub.names import list_entries
from owtsweep.studies.hub.records import make_records_at
from owtsweep.studies.hub.resolving import resolve_all
from owtsweep.studies.hub.sensors import observe

UNITS = {
    "position": "m, north and east",
    "velocity": "m/s, north and east",
    "specific_force": "m/s^2, in the frame of the IMU",
    "fixes": "m, north and east, of sensors.gnss.delay seconds before",
}


def estimate_record(config: HubConfig, replicate: int) -> EstimatedRecord:
    """Make a record, run schemes and baselines on it step by step, and return all of it.

    Raises
    ------
    InputError
        If the grid has several cells, or the plant cannot be computed.
    """
    conditions = find_only_cell(get_grid(config), find_world(config).section)
    of_motion = dict(conditions)
    amplitude = float(of_motion.pop("amplitude", 1.0))
    records = make_records_at(config, of_motion, [replicate])
    motion, noise, sensors = records.motion[0], records.noise[0], records.sensors
    observed = observe(motion, records.direction, sensors)
    force = amplitude * observed.specific_force + noise.specific_force
    fixes = amplitude * observed.fixes + noise.fixes
    time = sensors.step * np.arange(len(force))
    estimates: dict[str, dict[str, Array]] = {}
    covariances: dict[str, dict[str, Array]] = {}
    failures = {}
    for scheme in resolve_all(list_entries(config), config):
        known = tell(scheme, Known(sensors, config), conditions, amplitude)
        try:
            estimator = start(scheme, known)
            found = run_estimator(estimator, force, fixes, sensors.fix_interval)
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # a user's scheme may raise anything
            failures[scheme.name] = as_text(error)
            continue
        estimates[scheme.name] = {"position": found.state[:, :2], "velocity": found.state[:, 2:]}
        P = found.covariance
        covariances[scheme.name] = (
            {} if P is None else {"position": P[:, :2, :2], "velocity": P[:, 2:, 2:]}
        )
    return EstimatedRecord(
        study=config.study,
        tuning=config.tuning_name,
        conditions=conditions,
        replicate=replicate,
        settled=round(config.measures.settling_time / sensors.step),
        time=time,
        truth={
            "position": amplitude * np.outer(motion.position, records.direction),
            "velocity": amplitude * np.outer(motion.velocity, records.direction),
        },
        measurements={
            "specific_force": Reading(time, force),
            "fixes": Reading(time[:: sensors.fix_interval][: len(fixes)], fixes),
        },
        estimates=estimates,
        covariances=covariances,
        waits=dict.fromkeys(estimates, 0.0),
        units=UNITS,
        failures=failures,
    )
