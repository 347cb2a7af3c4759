"""What schemes of the hub study are not told: the keys of the truth alone, and worlds by name."""

from __future__ import annotations

from functools import cache

from owtsweep.config import Plain, conf_directory
from owtsweep.config.stored import read
from owtsweep.studies.base.worlds import Departure, Untold
from owtsweep.studies.hub.config import HubConfig

#: Keys of the sensors that change what is measured, while schemes are told the configuration's.
#: Not yaw, gravity and rates: records come to kernels in the frame and at the steps that are told.
OF_SENSORS = (
    "sensors.gnss.sigma", "sensors.gnss.delay", "sensors.gnss.scale", "sensors.gnss.outliers",
    "sensors.gnss.loss", "sensors.gnss.correlation", "sensors.imu.sigma",
    "sensors.imu.bias_initial", "sensors.imu.bias_walk", "sensors.imu.tilt",
    "sensors.imu.high_pass",
)  # fmt: skip
#: Keys of the motion, by the value of `motion.kind`.
OF_MOTION = {
    "spectrum": ("spectrum.bandwidth", "motion.peaks", "motion.pace", "motion.envelope"),
    "plant": ("motion.gamma", "motion.modes", "motion.damping"),
}
#: Slope of the first mode's shape at the hub of the structure ren2019, rad/m.
LEAN = 0.0137
SENSORS = {
    "leaning_out": Departure(
        f"the IMU leans the way that it moves, by {LEAN} rad/m", {"sensors.imu.tilt": LEAN}
    ),
    "leaning_back": Departure(
        f"the IMU leans against the way that it moves, by {LEAN} rad/m", {"sensors.imu.tilt": -LEAN}
    ),
    "red_fixes": Departure(
        "red noise of the fixes, .1 m with a time constant of 300 s",
        {"sensors.gnss.correlation.sigma": 0.1, "sensors.gnss.correlation.time": 300.0},
    ),
    "outliers_1": Departure(
        "1 % of the fixes are outliers of 10 standard deviations",
        {"sensors.gnss.outliers.rate": 0.01},
    ),
    "outliers_5": Departure(
        "5 % of the fixes are outliers of 10 standard deviations",
        {"sensors.gnss.outliers.rate": 0.05},
    ),
    "multipath": Departure(
        "5 % of the fixes are outliers, in bursts of 5 with one offset",
        {"sensors.gnss.outliers.rate": 0.05, "sensors.gnss.outliers.length": 5},
    ),
}


def list_untold(config: HubConfig) -> Untold:
    """Return what schemes are not told of truth and measurements."""
    departures = dict(SENSORS)
    if config.motion.kind == "spectrum":
        departures |= _list_motions(config.record.duration)
    return Untold((*OF_SENSORS, *OF_MOTION[config.motion.kind]), departures)


def _list_motions(duration: float) -> dict[str, Departure]:
    middle = 0.5 * duration
    ends = [max(middle - 150.0, 0.0), min(middle + 150.0, duration)]
    return {
        "two_peaks": Departure(
            "peaks at .1 and .26 Hz share the variance, in place of the natural period's",
            {"motion.peaks": [0.1, 0.26]},
        ),
        "plant_seas": Departure(
            "the structure ren2019 in a sea of hs 2 m and tp 8 s, its time stretched until its "
            "first mode has the cell's natural period, with the cell's amplitude",
            {"structure": _read_structure(), "motion.hs": [2.0], "motion.tp": [8.0]},
        ),
        "drifting_period": Departure(
            "the period falls by 10 % in 300 s in the middle of a record",
            {"motion.pace": [[ends[0], 1.0], [ends[1], 1.0 / 0.9]]},
        ),
    }


@cache
def _read_structure() -> Plain:
    return read(conf_directory() / "structure" / "ren2019.yaml")
