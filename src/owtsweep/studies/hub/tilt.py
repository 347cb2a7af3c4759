"""Warns of an IMU that leans so much that no filter can bridge the time between two fixes."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from math import sqrt
from typing import Any

from owtsweep.config import typed
from owtsweep.errors import InputError
from owtsweep.gravity import GRAVITY
from owtsweep.structures import Structure, compute_modes
from owtsweep.studies.hub.sections import Imu, MotionConfig, SensorConfig

logger = logging.getLogger(__name__)

#: Largest exponent of an error's growth between two fixes for which there is no warning.
LARGEST_GROWTH = 3.0


def find_tilt(plain: Mapping[str, Any], imu: Imu) -> float:
    """Return the tilt that a filter may know, rad/m; `plain` is a configuration as plain data.

    If the IMU leans as the structure does, the tilt is the slope of the first mode, with the least
    of `motion.blades` and the structure's own soil. It has four digits, so that it is the same on
    every machine. It is 0 if there is no such structure; the configuration's checks tell that.

    A filter multiplies the tilt by `GRAVITY`. If the structure has another acceleration of gravity,
    the tilt makes up for the difference.
    """
    if not isinstance(imu.tilt, str):
        return imu.tilt
    try:
        structure = typed(Structure, plain.get("structure"))
        structure.check()
        blades = min(typed(MotionConfig, plain.get("motion")).blades or [0])
        slope = compute_modes(structure, 1, blades).slope[0] * (structure.gravity / GRAVITY)
    except InputError:
        return 0.0
    return float(f"{slope:.4g}")


def warn_of_growth(plain: Mapping[str, Any]) -> None:
    """Log a warning if the sensors' tilt lets errors grow more than e^`LARGEST_GROWTH` times.

    In p'' = f + g tilt p + b an error grows as exp(sqrt(g tilt) t) while no fix corrects it; the
    longest such time is the fixes' interval and their delay. `plain` is a configuration as plain
    data.
    """
    try:
        sensors = typed(SensorConfig, plain.get("sensors"))
    except InputError:
        return  # typing the whole configuration names the fault
    alone = 1.0 / sensors.gnss.rate + sensors.gnss.delay
    tilt = find_tilt(plain, sensors.imu)
    growth = sqrt(max(GRAVITY * tilt, 0.0)) * alone
    if growth > LARGEST_GROWTH:
        logger.warning(
            "sensors.imu.tilt: %g rad/m lets an error grow exp(%.1f) times in the %g s without a "
            "fix; no filter follows that, so give a smaller tilt or faster fixes",
            tilt, growth, alone,
        )  # fmt: skip
