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


class ForceNoise:
    """All of the specific force that is not motion, drawn piece by piece.

    Gravity -R' g, the bias' Wiener process, white noise. `stream` gives the generator of a name:
    imu_x, imu_y, bias_x, bias_y. They yield unit normals that are scaled here, so changing an
    intensity keeps the noise; and in order, so the pieces are those of one draw, bit for bit.
    """

    def __init__(
        self,
        config: SensorConfig,
        sensors: Sensors,
        stream: Callable[[str], np.random.Generator],
    ) -> None:
        self.walk = config.imu.bias_walk * np.sqrt(sensors.step)
        self.sigma = sensors.force_sigma
        self.gravity = sensors.rotation.T @ np.array(sensors.gravity)
        self.generators = [(stream(f"bias_{axis}"), stream(f"imu_{axis}")) for axis in "xy"]
        self.initial = config.imu.bias_initial
        self.bias: list[float] | None = None

    def draw(self, normals: Array) -> None:
        """The next unit normals of bias_x, imu_x, bias_y, imu_y into (4, steps), for the kernels.

        A record is taken either by this or by `next`.
        """
        for row, generator in zip(normals, sum(self.generators, ()), strict=True):
            generator.standard_normal(out=row)

    def next(self, steps: int) -> Array:
        """The next (steps, 2) in the IMU's frame, m/s^2."""
        force = np.empty((steps, 2))
        last = []
        for axis, (walk, white) in enumerate(self.generators):
            bias = walk.standard_normal(steps)
            bias *= self.walk
            bias[0] = self.initial if self.bias is None else self.bias[axis] + bias[0]
            np.cumsum(bias, out=bias)
            last.append(bias[-1])
            noise = white.standard_normal(steps)
            noise *= self.sigma
            noise += bias
            np.subtract(noise, self.gravity[axis], out=force[:, axis])
        self.bias = last
        return force


def noise(
    config: SensorConfig,
    sensors: Sensors,
    steps: int,
    stream: Callable[[str], np.random.Generator],
) -> Measurements:
    """All that is not motion in a whole record: of the specific force, and of the fixes."""
    force = ForceNoise(config, sensors, stream).next(steps)
    return Measurements(force, fix_noise(sensors, steps, stream))


def fix_noise(sensors: Sensors, steps: int, stream: Callable[[str], np.random.Generator]) -> Array:
    """(fixes, 2) white noise of the fixes of a record, m, from the stream gnss."""
    count = fix_count(steps, sensors.fix_interval)
    return sensors.position_sigma * stream("gnss").standard_normal((count, 2))
