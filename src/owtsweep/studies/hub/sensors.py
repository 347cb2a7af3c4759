"""What GNSS and IMU report of a motion, Eqs. (3)-(5) of Ren et al. (2019).

Signal and noise are made separately. So superposition can run them side by side, and a record's
noise does not depend on its motion.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.source import Motion
from owtsweep.sensing.noise import WhiteNoise, WienerBias
from owtsweep.studies.hub.config import SensorConfig
from owtsweep.studies.hub.contract import Sensors


class Measurements(NamedTuple):
    """specific_force (steps, 2) in the IMU's frame, m/s^2; fixes (fixes, 2) in NED, m."""

    specific_force: Array
    fixes: Array


def sensors(config: SensorConfig) -> Sensors:
    """What an estimator may know about the configured sensors."""
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
    """How many fixes arrive in a record: they come at steps 0, M, 2 M, ..."""
    return -(-steps // fix_interval)


def observe(motion: Motion, direction: Array, sensors: Sensors) -> Measurements:
    """The part of Eqs. (3) and (4) that comes from motion: R' vdot and p(t - tau_d).

    Parameters
    ----------
    motion
        The displacement along `direction`, which is (2,) in NED.
    """
    force = motion.acceleration[:, None] * (sensors.rotation.T @ direction)
    count = fix_count(len(motion.position), sensors.fix_interval)
    delayed = motion.position_at(-sensors.delay, sensors.fix_interval, count)
    return Measurements(force, delayed[:, None] * direction)


class ForceNoise:
    """All of the specific force that is not motion: gravity -R' g, bias and white noise.

    It is drawn piece by piece from the streams bias_x, imu_x, bias_y and imu_y, which `stream`
    gives by name. They yield unit normals that are scaled here (`owtsweep.sensing.noise`).
    """

    def __init__(
        self,
        config: SensorConfig,
        sensors: Sensors,
        stream: Callable[[str], np.random.Generator],
    ) -> None:
        imu = config.imu
        self.bias = [
            WienerBias(stream(f"bias_{axis}"), imu.bias_walk, sensors.step, imu.bias_initial)
            for axis in "xy"
        ]
        self.white = [WhiteNoise(stream(f"imu_{axis}"), sensors.force_sigma) for axis in "xy"]
        self.gravity = sensors.rotation.T @ np.array(sensors.gravity)

    def draw(self, normals: Array) -> None:
        """Write the next unit normals of bias_x, imu_x, bias_y, imu_y to `normals` (4, steps).

        The kernels scale them. For one record, use either this or `next`.
        """
        for axis in range(2):
            self.bias[axis].generator.standard_normal(out=normals[2 * axis])
            self.white[axis].generator.standard_normal(out=normals[2 * axis + 1])

    def next(self, steps: int) -> Array:
        """The noise of the next steps, (steps, 2) in the IMU's frame, m/s^2."""
        force = np.empty((steps, 2))
        for axis in range(2):
            total = self.white[axis].draw(steps)
            total += self.bias[axis].draw(steps)
            np.subtract(total, self.gravity[axis], out=force[:, axis])
        return force


def noise(
    config: SensorConfig,
    sensors: Sensors,
    steps: int,
    stream: Callable[[str], np.random.Generator],
) -> Measurements:
    """The part of a whole record's measurements that does not come from motion."""
    force = ForceNoise(config, sensors, stream).next(steps)
    return Measurements(force, fix_noise(sensors, steps, stream))


def fix_noise(sensors: Sensors, steps: int, stream: Callable[[str], np.random.Generator]) -> Array:
    """(fixes, 2) white noise of the fixes of a record, m, from the stream gnss."""
    white = WhiteNoise(stream("gnss"), sensors.position_sigma)
    return white.draw(fix_count(steps, sensors.fix_interval), 2)


def simulate_bias(
    config: SensorConfig,
    sensors: Sensors,
    steps: int,
    stream: Callable[[str], np.random.Generator],
    *,
    piece: int | None = None,
) -> Iterator[Array]:
    """Yield R b^b of a record, (steps, 2) m/s^2 in NED, in pieces.

    Parameters
    ----------
    stream
        Gives the random generator for a name. With the streams of a record's noise, the bias is
        the one in that noise.
    piece
        Steps of a piece; the whole record at once by default.
    """
    biases = ForceNoise(config, sensors, stream).bias
    size = piece or steps
    for begin in range(0, steps, size):
        length = min(size, steps - begin)
        bias = np.stack([axis.draw(length) for axis in biases], axis=1)
        yield np.asarray(bias @ sensors.rotation.T)
