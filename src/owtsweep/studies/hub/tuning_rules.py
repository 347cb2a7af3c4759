"""Fills in the numbers that `tuning=matched` leaves to the sensors (`auto` in its file), by rule.

The rules come from searches by `owtsweep tune` over sensors, one property varied at a time
(docs/tuning.md). They depend on the sensors only: not on the grid, the amplitudes or the spectrum.
A tilt that no filter follows is warned of.
"""

from __future__ import annotations

import logging
from functools import cache
from math import sqrt
from operator import attrgetter
from typing import Any, NamedTuple, TypeVar

from owtsweep.config import Plain, changed, typed, with_values
from owtsweep.errors import InputError
from owtsweep.gravity import GRAVITY
from owtsweep.structures import Structure, compute_modes
from owtsweep.studies.hub.config import TUNED, Gnss, HubConfig, Imu, MotionConfig, SensorConfig
from owtsweep.studies.hub.scheme_sections import Tuning

logger = logging.getLogger(__name__)

C = TypeVar("C", bound=HubConfig)

#: The value of a key that follows from the sensors.
AUTO = "auto"


class Facts(NamedTuple):
    """The properties of the sensors on which the rules depend, in the order of `VALID`.

    gnss_sigma, imu_sigma: standard deviations of a fix (m) and of a sample (m/s^2), per axis.
    gnss_rate, imu_rate: fixes and samples per second, Hz.
    delay: age of a fix when it arrives, s.
    bias_walk: intensity of the IMU's bias walk, m/s^2/sqrt(s).
    """

    gnss_sigma: float
    gnss_rate: float
    delay: float
    imu_sigma: float
    imu_rate: float
    bias_walk: float


#: The sections that hold a filter.
FILTERS = ("ekf", "mkf", "hme1", "hme2")
#: The sensors of `sensors=ren2019`. Their numbers for HME2 are those of a search that is over, so
#: that stored runs of `tuning=matched` keep their blocks.
DEFAULT = Facts(
    gnss_sigma=0.03, gnss_rate=1.0, delay=0.2, imu_sigma=0.15, imu_rate=100.0, bias_walk=1e-4
)
RECORDED = {
    "hme2.q_a": 13.9,
    "hme2.r_gnss.scale": 0.0611,
    "hme.mhe.interval": 0.2,
    "hme.mhe.horizon": 32,
    "hme.mhe.smoother_window": 32,
}
#: The scheme whose numbers these are.
RECORDED_FOR = "HME2"
#: Between these ends, each property alone, the rules were compared with searches.
VALID = {
    "sensors.gnss.sigma": (0.005, 0.3),
    "sensors.gnss.rate": (1.0, 10.0),
    "sensors.gnss.delay": (0.0, 1.0),
    "sensors.imu.sigma": (0.01, 0.5),
    "sensors.imu.rate": (50.0, 200.0),
    "sensors.imu.bias_walk": (0.0, 3e-3),
}


def compute_numbers(facts: Facts) -> Plain:
    """Return key -> number for all keys that may be `auto`, by rule.

    A property beyond the range `VALID` counts as the range's end.
    """
    near = Facts(
        *(min(max(v, low), high) for v, (low, high) in zip(facts, VALID.values(), strict=True))
    )
    gnss = near.gnss_sigma / DEFAULT.gnss_sigma  # each relative to the default
    rate = near.gnss_rate / DEFAULT.gnss_rate
    imu = near.imu_sigma / DEFAULT.imu_sigma
    samples = near.imu_rate / DEFAULT.imu_rate
    walk = near.bias_walk / 1e-3
    window = round(0.02 * facts.imu_rate)
    # The MHE does best with the shortest window. Its positions already hold the filter's own past,
    # so they get a variance several times that of a fix; less if the bias has to be tracked fast.
    scale = 10.0 * imu**0.5 * rate**0.5 / (1.0 + 2.0 * walk)
    quotient = (24.0 * imu**2 + 5.5 * imu + 5.0 * walk) * samples
    return {
        "ekf.q_a": 0.455 * imu**1.7,
        "mkf.q_a": 0.455 * imu**1.7,
        "hme1.q_a": 1.07 * imu**1.8,
        "hme.smoother_window": window,
        "hme2.q_a": quotient * (scale + 1.5 * gnss * rate),
        "hme2.r_gnss.scale": scale,
        "hme.mhe.interval": max(round(facts.imu_rate / facts.gnss_rate), 1) / facts.imu_rate,
        "hme.mhe.horizon": 1,
        "hme.mhe.smoother_window": window,
    }


def fill_in(plain: Plain) -> Plain:
    """Return plain keys, of one tuning or several, with the rules' numbers in place of `auto`.

    A warning is logged if `auto` stands for sensors beyond those that the rules were made for, or
    if the tilt is one that no filter follows.
    """
    try:
        sensors = typed(SensorConfig, plain.get("sensors"))
    except InputError:
        return plain  # typing the whole configuration names the fault
    tilt = find_tilt(plain, sensors.imu)
    _warn_of_growth(sensors.gnss, tilt)

    @cache
    def find_numbers() -> Plain:
        facts = take_facts(sensors)
        _warn(facts)
        return _compute(facts) | {f"{section}.tilt": tilt for section in FILTERS}

    def fill(value: Any, key: str) -> Any:
        if isinstance(value, dict):
            return {name: fill(inner, f"{key}.{name}") for name, inner in value.items()}
        return find_numbers().get(key, value) if value == AUTO else value

    def fill_sections(part: Plain) -> Plain:
        return {name: fill(v, name) if name in TUNED else v for name, v in part.items()}

    filled, tunings = fill_sections(plain), plain.get("tunings")
    if isinstance(tunings, dict):
        filled["tunings"] = {
            name: fill_sections(part) if isinstance(part, dict) else part
            for name, part in tunings.items()
        }
    return filled


def follow_sensors(config: C, sensors: SensorConfig) -> C:
    """Return a configuration with other sensors.

    With `tuning=matched`, each number that equals what the rules give for the old sensors becomes
    what they give for the new ones. A number that the user has set, and any other tuning, stays.
    """
    moved = changed(config, sensors=sensors)
    if config.tuning != "matched":
        return moved
    before, after = _compute(take_facts(config.sensors)), _compute(take_facts(sensors))
    tuning = Tuning(**{name: getattr(config, name) for name in TUNED})
    kept = {key: after[key] for key in before if attrgetter(key)(tuning) == before[key]}
    return changed(moved, **vars(with_values(tuning, kept)))


def take_facts(sensors: SensorConfig) -> Facts:
    """Return the properties of configured sensors; sigmas as standard deviations."""
    return Facts(
        gnss_sigma=sensors.gnss.sigma / sensors.deviations,
        gnss_rate=sensors.gnss.rate,
        delay=sensors.gnss.delay,
        imu_sigma=sensors.imu.sigma / sensors.deviations,
        imu_rate=sensors.imu.rate,
        bias_walk=sensors.imu.bias_walk,
    )


def _warn(facts: Facts) -> None:
    for value, (key, (low, high)) in zip(facts, VALID.items(), strict=True):
        if not low <= value <= high:
            logger.warning(
                "%s: %g lies beyond %g to %g, for which the rules of tuning=matched were made; "
                "`owtsweep tune` finds those of EKF, MKF, HME1 and HME2 for these sensors",
                key, value, low, high,
            )  # fmt: skip


def _compute(facts: Facts) -> Plain:
    """Return the rules' numbers, for the default sensors, whatever their bias walk, `RECORDED`."""
    default = facts._replace(bias_walk=DEFAULT.bias_walk) == DEFAULT
    return compute_numbers(facts) | (RECORDED if default else {})


def assume_tilt(config: C, tilt: float) -> C:
    """Return the configuration with filters that assume a tilt, rad/m."""
    filters = {name: changed(getattr(config, name), tilt=tilt) for name in FILTERS}
    return changed(config, **filters)


#: Largest exponent of an error's growth between two fixes for which there is no warning.
LARGEST_GROWTH = 3.0


def find_tilt(plain: Plain, imu: Imu) -> float:
    """Return the tilt that a filter may know, rad/m; `plain` is a configuration as plain data.

    If the IMU leans as the structure does, the tilt is the slope of the first mode, with the least
    of `motion.blades` and the structure's own soil. It has four digits, so that it is the same on
    every machine. It is 0 if there is no such structure; the configuration's checks tell that. A
    filter multiplies the tilt by `GRAVITY`. If the structure has another acceleration of gravity,
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


def _warn_of_growth(gnss: Gnss, tilt: float) -> None:
    """Log a warning if a tilt (rad/m) lets errors grow more than e^`LARGEST_GROWTH` times.

    In p'' = f + g tilt p + b an error grows as exp(sqrt(g tilt) t) while no fix corrects it; the
    longest such time is the fixes' interval and their delay.
    """
    alone = 1.0 / gnss.rate + gnss.delay
    growth = sqrt(max(GRAVITY * tilt, 0.0)) * alone
    if growth > LARGEST_GROWTH:
        logger.warning(
            "sensors.imu.tilt: %g rad/m lets an error grow exp(%.1f) times in the %g s without a "
            "fix; no filter follows that, so give a smaller tilt or faster fixes",
            tilt, growth, alone,
        )  # fmt: skip
