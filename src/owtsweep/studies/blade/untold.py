"""What schemes of the blade study are not told: worlds in which lift and sensors are otherwise.

Outages are left out, because what is judged follows from them, and errors of the start, which
schemes are told as they are.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.studies.base.worlds import Departure, Untold

if TYPE_CHECKING:
    from owtsweep.studies.blade.config import BladeConfig

KEYS = (
    "grid.sigma", "grid.offset", "grid.lever", "grid.period", "grid.amplitude", "grid.heading",
    "motion.freedoms", "motion.gust_time", "motion.bending", "motion.tugger", "unit.force_sigma",
    "unit.force_bias", "unit.force_walk", "unit.rate_sigma", "unit.rate_bias", "unit.rate_walk",
    "sensors.receiver", "sensors.prism_sigma", "sensors.prism_offset", "sensors.stretch",
)  # fmt: skip


def list_untold(config: BladeConfig) -> Untold:
    """Return what schemes are not told; a world that moves an axis of the map is none.

    A recorded lift is as it is.
    """
    if config.recorded.imu is not None:
        return Untold()
    swing = config.motion.freedoms["u"].period
    departures = {
        "red_fixes": Departure(
            "slow errors of the fixes, .02 m with a time constant of 60 s",
            {"sensors.receiver.red_sigma": 0.02},
        ),
        "reflections": Departure(
            "fixes jump by some .05 m for 5 s, once a minute",
            {"sensors.receiver.jump_every": 60.0},
        ),
        "late": Departure("time stamps of the fixes come .05 s late", {"grid.offset": 0.05}),
        "lever": Departure("the antenna stands .05 m from where it should", {"grid.lever": 0.05}),
        "longer_swing": Departure(
            "the longitudinal swing takes a fifth longer", {"grid.period": 1.2 * swing}
        ),
    }
    mapped = {f"grid.{axis}" for axis in config.axes}
    return Untold(KEYS, {n: each for n, each in departures.items() if not mapped & {*each.keys}})
