"""Simulates what GNSS and IMU report of a motion, Eqs. (3) to (5) of Ren et al. (2019).

The parts of the measurements that are due to motion and to noise are made separately. So an
estimator can be run on each part alone, and a record's noise does not depend on its motion.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.gravity import GRAVITY
from owtsweep.motion.source import Motion
from owtsweep.sensing.faults import draw_losses, draw_outliers
from owtsweep.sensing.noise import WienerBias, draw_gauss_markov
from owtsweep.streams import Streams
from owtsweep.studies.hub.config import STRUCTURE, SensorConfig


@dataclass(frozen=True)
class Sensors:
    """The properties of IMU and GNSS that an estimator may know.

    step: sampling interval T_a of the IMU, s.
    fix_interval: number M of IMU steps between position fixes, which arrive at steps 0, M, 2 M, ...
    delay: number N_d of IMU steps from the instant whose position a fix reports to the fix's
        arrival.
    position_sigma, force_sigma: standard deviations per axis: of a fix (m) and of an IMU sample
        (m/s^2).
    bias_walk: intensity of the bias' Wiener process, m/s^2/sqrt(s).
    yaw: fixed yaw psi of the IMU, rad.
    gravity: horizontal part of gravity, north and east, m/s^2.
    tilt: lean of the IMU per displacement, rad/m. The paper neglects it (section 3, assumption 2).
    high_pass: corner of the IMU's AC coupling, Hz, or None. Estimators of the package do not use
        it.
    fix_scale: position in a fix per true position. Estimators of the package do not use it.
    """

    step: float
    fix_interval: int
    delay: int
    position_sigma: float
    force_sigma: float
    bias_walk: float
    yaw: float
    gravity: tuple[float, float]
    tilt: float = 0.0
    high_pass: float | None = None
    fix_scale: float = 1.0

    @property
    def lean(self) -> float:
        """The specific force by leaning, g tilt, in m/s^2 per metre of displacement.

        The IMU's x axis points outwards; where the tower leans outwards by theta, it points down by
        theta. So gravity, which an IMU feels as an acceleration upwards, gives -g sin theta.
        """
        return GRAVITY * self.tilt

    @property
    def rotation(self) -> Array:
        """The matrix R (2, 2), Eq. (5) of the paper, from the IMU's frame to NED."""
        cos, sin = np.cos(self.yaw), np.sin(self.yaw)
        return np.array([[cos, -sin], [sin, cos]])

    @property
    def fix_step(self) -> float:
        """The time T_g between position fixes, s."""
        return self.fix_interval * self.step


class Measured(NamedTuple):
    """What the sensors of a record say, or the part that motion or noise contributes to it.

    specific_force: in the IMU's frame, m/s^2, shape (steps, 2).
    fixes: positions in NED, m, shape (fixes, 2), at the steps 0, M, 2 M, ...; NaN where one is
        lost.
    """

    specific_force: Array
    fixes: Array

    def add_noise(self, amplitude: float, noise: Measured) -> Measured:
        """Return what sensors say of this motion times an amplitude."""
        return Measured(
            amplitude * self.specific_force + noise.specific_force,
            amplitude * self.fixes + noise.fixes,
        )


def sensors(config: SensorConfig) -> Sensors:
    """Compute from the configuration what an estimator may know about the sensors.

    The tilt is 0 if it is the structure's own, which these keys do not know.
    """
    step = 1.0 / config.imu.rate
    return Sensors(
        step=step,
        fix_interval=round(config.imu.rate / config.gnss.rate),
        delay=round(config.gnss.delay / step),
        position_sigma=config.gnss.sigma / config.deviations,
        force_sigma=config.imu.sigma / config.deviations,
        bias_walk=config.imu.bias_walk,
        yaw=float(np.deg2rad(config.yaw)),
        gravity=(float(config.gravity[0]), float(config.gravity[1])),
        tilt=0.0 if isinstance(config.imu.tilt, str) else config.imu.tilt,
        high_pass=config.imu.high_pass,
        fix_scale=config.gnss.scale,
    )


def fix_count(steps: int, fix_interval: int) -> int:
    """Return the number of fixes in a record of `steps` steps; the first arrives at step 0."""
    return -(-steps // fix_interval)


def lean(motion: Motion, tilt: float | str) -> Motion:
    """Return a motion with what an IMU feels of it that leans: as its structure, or by rad/m."""
    if tilt == STRUCTURE:
        return motion  # it says what is felt
    lean = GRAVITY * float(tilt)
    felt = motion.acceleration - lean * motion.position if lean else None
    return replace(motion, felt=felt)


def couple(motion: Motion, sensors: Sensors) -> Motion:
    """Return a motion with what an AC-coupled IMU feels of it; unchanged without a coupling."""
    if sensors.high_pass is None:
        return motion
    # The coupling has settled before the record begins. What it has taken off by then is the slow
    # part of the force; for a motion that is fast against the corner that is w v - w^2 d.
    corner = 2.0 * np.pi * sensors.high_pass
    start = corner * (motion.velocity[0] - corner * motion.position[0])
    return replace(motion, felt=pass_high(motion.specific_force, corner, motion.step, start))


def pass_high(force: Array, corner: float, step: float, start: float) -> Array:
    """Pass a series (steps,), m/s^2, through a first-order high-pass.

    corner: angular frequency of the corner, rad/s.
    step: sampling interval of the series, s.
    start: slow part of the series at the first step, m/s^2.
    """
    from scipy.signal import lfilter

    # the bilinear transform of corner / (s + corner), which is the slow part
    ratio = 0.5 * corner * step
    gain, memory = ratio / (1.0 + ratio), (1.0 - ratio) / (1.0 + ratio)
    state = start - gain * force[0]
    slow, _ = lfilter([gain, gain], [1.0, -memory], force, zi=[state])
    return np.asarray(force - slow)


def force_per_displacement(omega: Array, sensors: Sensors) -> NDArray[np.complex128]:
    """Return what an IMU feels of a sinusoidal motion, per displacement, s^-2, shape (n,).

    `omega` are the angular frequencies, rad/s, shape (n,). The result multiplies e^{iwt}: the
    acceleration -w^2 and the lean, both through the AC coupling.
    """
    force = -(omega**2 + sensors.lean).astype(complex)
    if sensors.high_pass is not None:
        force *= 1j * omega / (1j * omega + 2.0 * np.pi * sensors.high_pass)
    return force


def observe(motion: Motion, direction: Array, sensors: Sensors) -> Measured:
    """Compute the part of the measurements that is due to motion, without gravity and noise.

    Sources: the term R' vdot in Eq. (3) and the term p(t - tau_d) in Eq. (4) of Ren et al. (2019).
        Lean and AC coupling of the IMU are as the motion says (`lean`, `couple`). `direction` is a
        unit vector (2,), north and east.
    """
    force = motion.specific_force[:, None] * (sensors.rotation.T @ direction)
    count = fix_count(len(motion.position), sensors.fix_interval)
    delayed = motion.position_at(-sensors.delay, sensors.fix_interval, count)
    return Measured(force, sensors.fix_scale * delayed[:, None] * direction)


class ForceNoise:
    """The part of the specific force that is not due to motion: gravity, bias and white noise.

    The noise is drawn piece by piece from the random streams bias_x, imu_x, bias_y and imu_y, as
    unit normals, which are scaled as in `owtsweep.sensing.noise`. Gravity enters as -R' g.
    """

    def __init__(self, config: SensorConfig, sensors: Sensors, stream: Streams) -> None:
        imu = config.imu
        self.bias = [
            WienerBias(stream(f"bias_{axis}"), imu.bias_walk, sensors.step, imu.bias_initial)
            for axis in "xy"
        ]
        self.white, self.sigma = [stream(f"imu_{axis}") for axis in "xy"], sensors.force_sigma
        self.gravity = sensors.rotation.T @ np.array(sensors.gravity)

    def next(self, steps: int) -> Array:
        """Draw the noise of the next steps, in the IMU's frame, in m/s^2, shape (steps, 2)."""
        force = np.empty((steps, 2))
        for axis in range(2):
            total = self.white[axis].standard_normal(steps)
            total *= self.sigma
            total += self.bias[axis].draw(steps)
            np.subtract(total, self.gravity[axis], out=force[:, axis])
        return force


def fix_noise(config: SensorConfig, sensors: Sensors, steps: int, stream: Streams) -> Array:
    """Draw what is added to a record's position fixes, m, shape (fixes, 2); NaN for a lost fix.

    That is white noise, and, if the configuration has them, red noise and outliers. Each has random
    streams of its own, so none changes another one: gnss, gnss_red, gnss_outliers,
    gnss_outlier_offsets and gnss_loss.
    """
    gnss, count = config.gnss, fix_count(steps, sensors.fix_interval)
    added = sensors.position_sigma * stream("gnss").standard_normal((count, 2))
    red, outliers = gnss.correlation, gnss.outliers
    if red.sigma > 0.0:
        added += draw_gauss_markov(
            stream("gnss_red"), count, sigma=red.sigma, time=red.time, step=sensors.fix_step
        )
    if outliers.rate > 0.0:
        added += draw_outliers(
            stream("gnss_outliers"),
            stream("gnss_outlier_offsets"),
            count,
            rate=outliers.rate,
            sigma=outliers.size * sensors.position_sigma,
            length=outliers.length,
        )
    if gnss.loses:
        loss = gnss.loss
        lost = draw_losses(stream("gnss_loss"), count, loss.probability, loss.length)
        added[lost] = np.nan
    return added


def simulate_bias(
    config: SensorConfig, sensors: Sensors, steps: int, stream: Streams, *, piece: int | None = None
) -> Iterator[Array]:
    """Yield the IMU's bias R b^b in a record, in NED, in m/s^2, in pieces of the shape (piece, 2).

    With the streams of a record, it is the bias in this record's noise. The last piece may be
    shorter; None for the whole record at once.
    """
    biases = ForceNoise(config, sensors, stream).bias
    size = piece or steps
    for begin in range(0, steps, size):
        length = min(size, steps - begin)
        bias = np.stack([axis.draw(length) for axis in biases], axis=1)
        yield np.asarray(bias @ sensors.rotation.T)
