"""Fills in the numbers that `tuning=matched` leaves to the sensors (`auto` in its file), by rule.

The rules come from searches by `owtsweep tune` over sensors, one property varied at a time
(docs/tuning.md). They depend on the sensors only: not on the grid, the amplitudes or the spectrum.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from owtsweep.config import typed
from owtsweep.errors import InputError
from owtsweep.studies.hub.config import TUNED, SensorConfig

logger = logging.getLogger(__name__)

#: The value of a key that follows from the sensors.
AUTO = "auto"


@dataclass(frozen=True)
class Facts:
    """The properties of the sensors on which the rules depend.

    Attributes
    ----------
    gnss_sigma, imu_sigma
        Standard deviations of a fix (m) and of a sample (m/s^2), per axis.
    gnss_rate, imu_rate
        Fixes and samples per second, Hz.
    delay
        Age of a fix when it arrives, s.
    """

    gnss_sigma: float
    gnss_rate: float
    delay: float
    imu_sigma: float
    imu_rate: float


#: The sensors of `sensors=ren2019`. Their numbers for HME2 are those of the recorded search
#: (experiment=readings), so that stored runs of `tuning=matched` keep their blocks.
DEFAULT = Facts(gnss_sigma=0.03, gnss_rate=1.0, delay=0.2, imu_sigma=0.15, imu_rate=100.0)
RECORDED = {
    "hme2.q_a": 13.9,
    "hme2.r_gnss.scale": 0.0611,
    "hme.mhe.interval": 0.2,
    "hme.mhe.horizon": 32,
    "hme.mhe.smoother_window": 32,
}
#: Between these ends, each property alone, the rules were compared with searches.
VALID = {
    "sensors.gnss.sigma": (0.005, 0.3),
    "sensors.gnss.rate": (1.0, 10.0),
    "sensors.gnss.delay": (0.0, 1.0),
    "sensors.imu.sigma": (0.01, 0.5),
    "sensors.imu.bias_walk": (1e-5, 3e-3),
}


def compute_numbers(facts: Facts) -> dict[str, Any]:
    """Return key -> number for all keys that may be `auto`."""
    # the density of the IMU's noise, relative to the default: a filter that trusts its IMU follows
    # the motion with less q_a
    imu = (facts.imu_sigma / DEFAULT.imu_sigma) ** 2 * (DEFAULT.imu_rate / facts.imu_rate)
    numbers: dict[str, Any] = {
        "ekf.q_a": 0.455 * imu**0.85,
        "mkf.q_a": 0.455 * imu**0.85,
        "hme1.q_a": 1.07 * imu**0.9,
        "hme.smoother_window": round(0.02 * facts.imu_rate),
    }
    if facts == DEFAULT:
        return numbers | RECORDED
    return numbers | {
        "hme2.q_a": 13.5,
        "hme2.r_gnss.scale": 0.143,
        "hme.mhe.interval": round(facts.imu_rate / facts.gnss_rate) / facts.imu_rate,
        "hme.mhe.horizon": 20,
        "hme.mhe.smoother_window": round(0.2 * facts.imu_rate),
    }


def fill_in(plain: dict[str, Any]) -> dict[str, Any]:
    """Return a configuration with the rules' numbers in place of `auto`.

    The configuration is plain data, of one tuning or of several. A warning is logged if `auto`
    stands for sensors beyond those that the rules were made for.
    """
    if not any(_holds_auto(part.get(section)) for part in _parts(plain) for section in TUNED):
        return plain
    facts = DEFAULT
    try:
        sensors = typed(SensorConfig, plain.get("sensors"))
    except InputError:
        pass  # typing the whole configuration names the fault
    else:
        facts = _take_facts(sensors)
        _warn(sensors)
    numbers = compute_numbers(facts)
    filled = _fill(plain, numbers)
    if plain.get("tunings"):
        filled["tunings"] = {n: _fill(part, numbers) for n, part in plain["tunings"].items()}
    return filled


def _parts(plain: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    tunings = plain.get("tunings")
    several = list(tunings.values()) if isinstance(tunings, dict) else []
    return [plain, *(part for part in several if isinstance(part, dict))]


def _holds_auto(value: Any) -> bool:
    if isinstance(value, dict):
        return any(_holds_auto(part) for part in value.values())
    return isinstance(value, str) and value == AUTO


def _fill(plain: Mapping[str, Any], numbers: Mapping[str, Any], path: str = "") -> dict[str, Any]:
    filled = {}
    for name, value in plain.items():
        key = f"{path}{name}"
        if isinstance(value, dict):
            filled[name] = _fill(value, numbers, f"{key}.")
        else:
            filled[name] = numbers.get(key, value) if value == AUTO else value
    return filled


def _take_facts(sensors: SensorConfig) -> Facts:
    deviations = 1.0 if sensors.accuracy == "sigma" else 3.0
    return Facts(
        gnss_sigma=sensors.gnss.sigma / deviations,
        gnss_rate=sensors.gnss.rate,
        delay=sensors.gnss.delay,
        imu_sigma=sensors.imu.sigma / deviations,
        imu_rate=sensors.imu.rate,
    )


def _warn(sensors: SensorConfig) -> None:
    """Log which properties lie beyond the range that the rules were made for."""
    for key, (low, high) in VALID.items():
        _, sensor, name = key.split(".")
        value = getattr(getattr(sensors, sensor), name)
        if not low <= value <= high:
            logger.warning(
                "%s: %g lies beyond %g to %g, for which the rules of tuning=matched were made; "
                "`python -m owtsweep tune` finds numbers for these sensors",
                key, value, low, high,
            )  # fmt: skip
