"""What GNSS and IMU report of a motion, Eqs. (3)-(5) of Ren et al. (2019).

Signal and noise are made apart: superposition runs them side by side, and the noise of a record
stays the same whatever moves.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.synthesis import Motion
from owtsweep.studies.hub.config import SensorConfig
from owtsweep.studies.hub.contract import Sensors


class Measurements(NamedTuple):
    """specific_force (steps, 2) in the IMU's frame, m/s^2; fixes (fixes, 2) in NED, m."""

    specific_force: Array
    fixes: Array


def sensors(config: SensorConfig) -> Sensors:
    """What estimators may know of the configured sensors."""
    step = 1.0 / config.imu.rate
    deviations = 1.0 if config.accuracy == "sigma" else 3.0
    return Sensors(
        step=step,
        fix_interval=round(config.imu.rate / config.gnss.rate),
        delay=round(config.gnss.delay / step),
        position_sigma=config.gnss.sigma / deviations,
        force_sigma=config.imu.sigma / deviations,
        bias_walk=config.imu.bias_walk,
        yaw=float(np.deg2rad(config.yaw)),
        gravity=(float(config.gravity[0]), float(config.gravity[1])),
    )


def fix_count(steps: int, fix_interval: int) -> int:
    """Fixes arrive at steps 0, M, 2 M, ... of the record."""
    return -(-steps // fix_interval)


def observe(motion: Motion, direction: Array, sensors: Sensors) -> Measurements:
    """The motion's own part of Eqs. (3) and (4): R' vdot and p(t - tau_d).

    Parameters
    ----------
    motion
        Displacement along `direction`, (2,) in NED.
    """
    force = motion.acceleration[:, None] * (sensors.rotation.T @ direction)
    count = fix_count(len(motion.position), sensors.fix_interval)
    delayed = motion.position_at(-sensors.delay, sensors.fix_interval, count)
    return Measurements(force, delayed[:, None] * direction)


def noise(
    config: SensorConfig,
    sensors: Sensors,
    steps: int,
    stream: Callable[[str], np.random.Generator],
) -> Measurements:
    """All that is not motion: gravity -R' g, the bias' Wiener process, white noise.

    `stream` gives the generator of a name: imu_x, imu_y, bias_x, bias_y, gnss. They yield unit
    normals that are scaled here, so changing an intensity keeps the noise.
    """
    force = np.empty((steps, 2))
    walk = config.imu.bias_walk * np.sqrt(sensors.step)
    for axis, name in enumerate("xy"):
        bias = walk * stream(f"bias_{name}").standard_normal(steps)
        bias[0] = config.imu.bias_initial
        np.cumsum(bias, out=bias)
        force[:, axis] = bias + sensors.force_sigma * stream(f"imu_{name}").standard_normal(steps)
    force -= sensors.rotation.T @ np.array(sensors.gravity)
    count = fix_count(steps, sensors.fix_interval)
    return Measurements(force, sensors.position_sigma * stream("gnss").standard_normal((count, 2)))
