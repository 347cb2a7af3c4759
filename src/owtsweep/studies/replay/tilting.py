"""Say what an IMU that leans with the tower costs at a record's motion, and whether it matters."""

from __future__ import annotations

from typing import Any

import numpy as np

from owtsweep.errors import InputError
from owtsweep.studies.hub.public import believe, make_sensors
from owtsweep.studies.replay.choosing import LEAST_MARGIN
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.place import expect_at_record


def describe_tilt(config: ReplayConfig, record: Any) -> str:
    """Say in a sentence what the tilt of the IMU costs at a record's period and size.

    The errors are those expected of the schemes for the fitted spectrum: by filters that know the
    tilt, and by filters that take the IMU for level. `record` is the record's row of records.csv.
    Returns "" if no tilt is stated (`sensors.imu.tilt`).
    """
    tilt = config.sensors.imu.tilt
    if isinstance(tilt, str) or tilt == 0.0:
        return ""
    told = f"a tilt of {tilt:g} rad/m"
    try:
        unaware, aware = (
            expect_at_record(believe(config, belief), record) for belief in (0.0, tilt)
        )
    except InputError as error:
        return f"{told}: what it costs cannot be computed: {error}"
    if not unaware or not aware:
        return f"{told}: the record has no place in the map, so what it costs is not known"
    lean = make_sensors(config.sensors).lean
    period = float(record["natural_period"])
    share = abs(lean) * (period / (2.0 * np.pi)) ** 2
    which = 1 if config.measures.criterion == "velocity" else 0
    unit = ("m", "m/s")[which]
    best_without = min(unaware, key=lambda name: unaware[name][which])
    best_known = min(aware, key=lambda name: aware[name][which])
    without, known = unaware[best_without][which], aware[best_known][which]
    verdict = "it does not matter at this period and size"
    if without > (1.0 + LEAST_MARGIN) * known:
        verdict = "it matters, so let the filters know it"
    elif known > (1.0 + LEAST_MARGIN) * without:
        verdict = "the motion is so small that filters do better if they take the IMU for level"
    return (
        f"{told} is {100.0 * share:.2g} % of the acceleration at {period:.3g} s; the least "
        f"expected error is {np.sqrt(without):.3g} {unit} ({best_without}) if the filters do not "
        f"know it, {np.sqrt(known):.3g} {unit} ({best_known}) if they do: {verdict}"
    )
