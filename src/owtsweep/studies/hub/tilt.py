"""The true tilt of the IMU as filters are told it, and a warning of one that none can follow."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from math import sqrt
from typing import Any

from owtsweep.config import typed
from owtsweep.errors import InputError
from owtsweep.studies.hub.contract import GRAVITY
from owtsweep.studies.hub.sections import SensorConfig

logger = logging.getLogger(__name__)

#: Largest exponent of an error's growth between two fixes for which there is no warning.
LARGEST_GROWTH = 3.0


def warn_of_growth(plain: Mapping[str, Any]) -> None:
    """Log a warning if the sensors' tilt lets errors grow more than e^`LARGEST_GROWTH` times.

    In p'' = f + g tilt p + b an error grows as exp(sqrt(g tilt) t) while no fix corrects it; the
    longest such time is the fixes' interval and their delay. `plain` is a configuration as plain
    data.
    """
    try:
        sensors = typed(SensorConfig, plain.get("sensors"))
        tilt = read_tilt(plain, sensors)
    except InputError:
        return  # typing the whole configuration names the fault
    alone = 1.0 / sensors.gnss.rate + sensors.gnss.delay
    growth = sqrt(max(GRAVITY * tilt, 0.0)) * alone
    if growth > LARGEST_GROWTH:
        logger.warning(
            "sensors.imu.tilt: %g rad/m lets an error grow exp(%.1f) times in the %g s without a "
            "fix; no filter follows that, so give a smaller tilt or faster fixes",
            tilt, growth, alone,
        )  # fmt: skip


def read_tilt(plain: Mapping[str, Any], sensors: SensorConfig) -> float:
    """Return the one tilt (rad/m) by which filters are told how the IMU leans.

    An IMU that leans as the structure does (`sensors.imu.tilt=structure`) has a tilt for each mode;
    filters are told that of the first mode, with the first number of mounted blades. `plain` is the
    configuration as plain data, `sensors` its section of that name.

    Raises
    ------
    InputError
        If the structure cannot be computed.
    """
    if isinstance(sensors.imu.tilt, float):
        return sensors.imu.tilt
    from owtsweep.structures import Structure, compute_modes

    structure = typed(Structure, plain.get("structure"))
    structure.check()
    match plain.get("motion"):
        case {"blades": [int(blades), *_]}:
            return float(compute_modes(structure, 1, blades).slope[0])
    return float(compute_modes(structure, 1).slope[0])
