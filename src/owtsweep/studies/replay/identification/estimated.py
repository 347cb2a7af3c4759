"""The configuration of a replay with the noise that the record shows in place of the stated one."""

from __future__ import annotations

import numpy as np

from owtsweep.config import changed
from owtsweep.studies.hub.public import follow_sensors
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.identification.of_record import Estimated, Noise


def use_estimates(config: ReplayConfig, noise: Noise) -> ReplayConfig:
    """Return the configuration with the estimated sensors.

    A parameter that the record bounds from both sides gets its estimate. Another keeps its stated
    value if this lies in the interval, and else gets the interval's nearest end. Numbers that
    `tuning=matched` computes from the sensors are computed again; all others of a tuning stay.
    """
    chosen = {one.parameter: _choose(one) for one in noise.parameters if not one.inside}
    gnss, imu = config.sensors.gnss, config.sensors.imu
    deviations = 1.0 if config.sensors.accuracy == "sigma" else 3.0
    if (sigma := chosen.get("sensors.gnss.sigma")) is not None:
        gnss = changed(gnss, sigma=_round(deviations * sigma))
    if (delay := chosen.get("sensors.gnss.delay")) is not None:
        gnss = changed(gnss, delay=max(round(delay * imu.rate), 0) / imu.rate)
    if (sigma := chosen.get("sensors.imu.sigma")) is not None:
        imu = changed(imu, sigma=_round(deviations * sigma))
    if (walk := chosen.get("sensors.imu.bias_walk")) is not None:
        imu = changed(imu, bias_walk=_round(walk))
    return follow_sensors(config, changed(config.sensors, gnss=gnss, imu=imu))


def _choose(one: Estimated) -> float:
    if one.bounded:
        return one.estimate
    return one.high if one.stated > one.high else one.low


def _round(value: float) -> float:
    """Return a value with three digits: no more are known, and other machines find the same."""
    return float(np.format_float_scientific(value, precision=2, unique=False))
