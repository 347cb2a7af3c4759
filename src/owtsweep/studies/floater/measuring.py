"""What the sensors of a record say: noise, bias, delay and losses.

Random numbers have streams of their own, so that a larger noise, another delay or more losses are
the same draws enlarged.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.sensing.faults import draw_losses
from owtsweep.streams import Streams
from owtsweep.studies.base.axes import Cell
from owtsweep.studies.floater.config import FloaterConfig
from owtsweep.studies.floater.contract import Measured
from owtsweep.studies.floater.truth import Motion

#: Time in s after which a drift of the bias is what the configuration says.
DRIFT_TIME = 100.0


class Sigmas(NamedTuple):
    """Standard deviations of the white noise of a record's sensors.

    Positions (6,) in m and rad, rates (3,) in rad/s; accelerations in m/s^2 and rad/s^2: (6,) with
    `frame: global`, (3,) of the accelerometers with `frame: body`.
    """

    position: Array
    rate: Array
    acceleration: Array


def find_sigmas(config: FloaterConfig, motion: Motion, snr: float) -> Sigmas:
    """Return the noise of the sensors at a signal-to-noise ratio (of powers) in dB.

    `sensors.power` says whether a signal's power is its variance or its mean square (which MATLAB's
    awgn takes, as the paper does).
    """
    sensors = config.sensors
    share = 10.0 ** (-snr / 20.0)

    def size(signal: Array) -> Array:
        if sensors.power == "square":
            return np.asarray(np.sqrt(np.mean(np.square(signal), axis=0)))
        return np.asarray(signal.std(axis=0))

    position = share * size(motion.truth.position)
    if sensors.sigma is not None:
        position = np.array(sensors.sigma)
        position[3:] = np.deg2rad(position[3:])
    exact = 0.0 if sensors.exact_inertial else 1.0
    return Sigmas(
        position,
        share * size(find_rates(config, motion)),
        exact * share * scale_accelerations(config, motion),
    )


def find_rates(config: FloaterConfig, motion: Motion) -> Array:
    """Return the true angular velocities that are measured, shape (steps, 3)."""
    truth = motion.truth
    return truth.rate if config.sensors.frame == "body" else truth.velocity[:, 3:]


def scale_accelerations(config: FloaterConfig, motion: Motion) -> Array:
    """Return the standard deviations of accelerations to which noise and bias refer, (6,) or (3,).

    With body-fixed sensors those of the motion, without gravity: leaning adds no noise.
    """
    columns = 3 if config.sensors.frame == "body" else 6
    return np.asarray(motion.truth.acceleration[:, :columns].std(axis=0))


def measure(config: FloaterConfig, motion: Motion, cell: Cell) -> Measured:
    """Return what the sensors say of a record in a cell of the grid."""
    draws = config.draws(motion.replicate)
    truth, sensors = motion.truth, config.sensors
    steps, step = len(truth.position), truth.step
    sigmas = find_sigmas(config, motion, cell["snr"])
    jitter = sensors.jitter * step * draws("jitter").standard_normal(steps)
    age = np.clip(cell["delay"] * step + jitter, 0.0, None)  # nobody reports the future
    position = motion.at(step * np.arange(steps) - age)
    wandering = wander(config, motion, draws("process"))
    if wandering is not None:
        shown = np.clip(np.arange(steps) - age / step, 0.0, None)
        position += np.column_stack(
            [np.interp(shown, np.arange(steps), column) for column in wandering[0].T]
        )
    position += sigmas.position * draws("position").standard_normal((steps, 6))
    lost = _lose(config, cell["loss"], draws("loss"))
    due = _find_due(config)
    lost &= due
    position[lost] = 0.0 if sensors.lost_as == "zeros" else np.nan
    position[~due] = np.nan
    rate = find_rates(config, motion)
    rate = rate + sigmas.rate * draws("rate").standard_normal((steps, 3))
    if wandering is not None:
        rate += wandering[1][:, 3:]
    body = sensors.frame == "body"
    felt = truth.specific_force if body else truth.acceleration
    columns = felt.shape[1]
    noise = draws("acceleration").standard_normal((steps, 6))[:, :columns]
    bias = _draw_bias(config, cell["bias"], draws, steps)[:, :columns]
    felt = felt + sigmas.acceleration * noise
    felt += bias * scale_accelerations(config, motion)
    return Measured(
        step=step,
        position=position,
        age=age,
        lost=lost,
        acceleration=None if body else felt,
        rate=rate,
        specific_force=felt if body else None,
    )


def wander(
    config: FloaterConfig, motion: Motion, draw: np.random.Generator
) -> tuple[Array, Array] | None:
    """Return by what the plant's positions and velocities wander from the truth, (steps, 6) each.

    White noise v_1 of the size of accelerations moves both (Eqs. 7 to 9); it is held over a step.
    None without `sensors.process_snr`.
    """
    ratio = config.sensors.process_snr
    if ratio is None:
        return None
    truth = motion.truth
    steps, h = len(truth.position), truth.step
    size = 10.0 ** (-ratio / 20.0) * truth.acceleration.std(axis=0)
    on_position, on_velocity = size * draw.standard_normal((2, steps, 6))
    velocity = np.cumsum(h * on_velocity, axis=0) - h * on_velocity
    change = h * on_position + h * velocity + 0.5 * h**2 * on_velocity
    return np.cumsum(change, axis=0) - change, velocity


def _draw_bias(config: FloaterConfig, bias: float, draws: Streams, steps: int) -> Array:
    """Return biases as parts of the accelerations' standard deviations, shape (steps, 6).

    They begin with the size `bias` and a random sign, and wander.
    """
    signs = np.where(draws("bias").random(6) < 0.5, -1.0, 1.0)
    drift = config.sensors.bias_drift
    if drift == 0.0:
        return np.broadcast_to(bias * signs, (steps, 6))
    change = drift * np.sqrt(1.0 / (config.record.rate * DRIFT_TIME))
    walk = np.cumsum(change * draws("bias_drift").standard_normal((steps, 6)), axis=0)
    return np.asarray(bias * signs + walk)


def _lose(config: FloaterConfig, share: float, draw: np.random.Generator) -> NDArray[np.bool_]:
    """Return which samples fall into a loss, shape (steps,)."""
    sensors, record = config.sensors, config.record
    length = max(round(sensors.loss_length * record.rate), 1)
    if sensors.loss_every is None:
        # An outage of this length begins so often that the share is lost in the long run.
        begins = 1.0 - (1.0 - share) ** (1.0 / length)
        return draw_losses(draw, record.steps, begins, length)
    every = round(sensors.loss_every * record.rate)
    sample = np.arange(record.steps)
    return np.asarray((sample >= every) & (sample % every < length))


def _find_due(config: FloaterConfig) -> NDArray[np.bool_]:
    """Return at which samples the optical system reports, shape (steps,)."""
    record, optical = config.record, config.sensors.optical_rate or config.record.rate
    # Rounding may not move a report that is due at a sample.
    count = np.floor(np.arange(record.steps) * optical / record.rate + 1e-9)
    return np.asarray(np.diff(count, prepend=-1.0) > 0.0)
