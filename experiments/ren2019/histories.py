"""Simulate time histories at the natural period 3.8 s, and measure the errors of HME1 and HME2.

Source: section 5.2 of Ren et al. (2019). This period is not in the paper's grid. So the histories
are simulated for the report on fidelity, with the run's configuration except for natural period and
amplitude. With motion=plant the structure moves in the sea of figures 9-14, Hs 2 m and Tp 6 s, or
in that sea state of the run which is nearest to it.
"""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from joblib import cpu_count

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.studies.hub import estimates
from owtsweep.studies.hub.chain import Chain, bias_of
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known, resolve_all
from owtsweep.studies.hub.histories import choose_sea
from owtsweep.studies.hub.records import Records, make_records, make_records_at
from owtsweep.studies.hub.sensors import simulate_bias
from owtsweep.studies.hub.worlds import find_world

#: Natural period of the case of section 5.2, s.
NATURAL_PERIOD = 3.8
#: Amplitude, m. Section 5.2 does not state it. There HME1 is better in position, so by Fig. 15 the
#: amplitude is above 0.3 m; 0.5 m is the next larger amplitude in section 5.3.
AMPLITUDE = 0.5
#: Both in words.
WHERE = f"{NATURAL_PERIOD:g} s, {AMPLITUDE:g} m"
#: The bound of F9 on the velocity error, m/s.
VELOCITY_BOUND = 0.05
SCHEMES = ("HME1", "HME2")
COLUMNS = ["history", "scheme", "quantity", "measure", "replicate", "value"]
MOST_REPLICATES = 20
#: More threads would wait for each other, and each needs a record's memory.
MOST_THREADS = 4


def measure_histories(config: HubConfig) -> pd.DataFrame | None:
    """Simulate HME1 and HME2 at a natural period of 3.8 s on the run's first 20 replicates at most.

    With motion=plant, simulate them in the sea state nearest to Hs 2 m, Tp 6 s.

    Returns
    -------
    DataFrame or None
        A table of scores; columns history, scheme, quantity, measure, replicate, value. `history`
        is the motion in words: natural period and amplitude, or the plant's sea. The measure
        "share_inside" of the quantity velocity is the share (0 to 1) of the samples of vx and vy
        whose absolute error is at most `VELOCITY_BOUND`, after the settling time. "accumulated" is
        the absolute error integrated over the whole record and summed over both axes, of position
        (m s), velocity (m) and bias (m/s).

        None if the run lacks HME1 or HME2, or if one of them has no kernel for the batch engine.
        None also if one of them is a user's scheme of a stored run (such code is not run), or if
        the run's spectrum does not exist at 3.8 s.
    """
    schemes = {scheme.name: scheme for scheme in resolve_all(config.schemes, config)}
    if not all(name in schemes and hasattr(schemes[name], "kernel") for name in SCHEMES):
        return None
    replicates = range(min(config.grid.greatest, MOST_REPLICATES))
    try:
        # The kernels release the GIL. A thread has one record at a time: 2000 s of one record take
        # tens of megabytes.
        with ThreadPoolExecutor(min(cpu_count(), MOST_THREADS)) as pool:
            measured = list(pool.map(partial(_measure_record, config, schemes), replicates))
    except InputError:
        return None
    world = find_world(config)
    history = WHERE if world.has_spectrum else world.describe_values(choose_sea(config))
    rows = [
        (history, scheme, quantity, measure, replicate, value)
        for replicate, errors in zip(replicates, measured, strict=True)
        for (scheme, quantity, measure), value in errors.items()
    ]
    return pd.DataFrame(rows, columns=COLUMNS)


def _measure_record(
    config: HubConfig, schemes: Mapping[str, Any], replicate: int
) -> dict[tuple[str, str, str], float]:
    """Simulate one record; return (scheme, quantity, measure) -> value for each of `SCHEMES`."""
    if find_world(config).has_spectrum:
        records, amplitude = make_records(config, NATURAL_PERIOD, [replicate]), AMPLITUDE
    else:
        records, amplitude = make_records_at(config, choose_sea(config), [replicate]), 1.0
    sensors = records.sensors
    bias = next(simulate_bias(config.sensors, sensors, records.steps, records.stream(0)))
    settled = round(config.measures.settling_time / sensors.step)
    result = {}
    for name in SCHEMES:
        chain = schemes[name].kernel(Known(sensors, config), records.steps)
        errors = absolute_errors(chain, records, bias, amplitude)
        inside = np.mean(errors["velocity"][settled:] <= VELOCITY_BOUND)
        result[name, "velocity", "share_inside"] = float(inside)
        for quantity, error in errors.items():
            result[name, quantity, "accumulated"] = float(np.sum(error)) * sensors.step
    return result


def absolute_errors(
    chain: Chain, records: Records, bias: Array, amplitude: float = AMPLITUDE
) -> dict[str, Array]:
    """Compute the absolute errors of one scheme at every step of one record.

    Parameters
    ----------
    chain
        The scheme, in its form for the batch engine.
    records
        One record.
    bias
        The true accelerometer bias R b^b in m/s^2, shape (steps, 2), as `simulate_bias` yields it.
    amplitude
        Factor on the motion of the record: the amplitude in m, or 1 for the plant's motion.

    Returns
    -------
    dict
        "position" (m), "velocity" (m/s) and "bias" (m/s^2) -> absolute errors, shape (steps, 2),
        columns x and y.
    """
    (motion,), along = records.motion, amplitude * records.direction
    force, fixes = records.measure(amplitude)
    position, velocity, _ = estimates.trajectories(chain, force, fixes)
    # The predictor keeps the bias constant, so the filter's newest estimate is the present one.
    estimated_bias = bias_of(estimates.states(chain, force, fixes), records.sensors)
    return {
        "position": np.abs(position - motion.position[:, None] * along),
        "velocity": np.abs(velocity - motion.velocity[:, None] * along),
        "bias": np.abs(estimated_bias - bias),
    }
