"""What the sensors of a record say: inertial unit, GNSS with outages and a clock, total stations.

Random numbers have streams of their own, so that a larger noise, a longer outage or another offset
are the same draws enlarged.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.sensing.faults import draw_outliers
from owtsweep.sensing.noise import draw_gauss_markov
from owtsweep.streams import Streams
from owtsweep.studies.base.axes import Cell
from owtsweep.studies.blade.boom import measure_boom
from owtsweep.studies.blade.config import BladeConfig
from owtsweep.studies.blade.contract import ANTENNAS, PRISMS, Measured
from owtsweep.studies.blade.sections import Receiver, Sensors, Unit
from owtsweep.studies.blade.truth import Motion

#: Time in s after which a walk of a bias is what the configuration says.
WALK_TIME = 100.0
#: Total stations report at irregular times: their intervals differ by up to this part.
IRREGULAR = 0.3


def measure(config: BladeConfig, motion: Motion, cell: Cell) -> Measured:
    """Return what the sensors say of a record in a cell of the grid."""
    draws = config.draws(motion.replicate)
    truth, sensors = motion.truth, config.sensors
    steps, step = len(truth.rate), truth.step
    time = step * np.arange(steps)
    force_bias, rate_bias = draw_biases(config.unit, draws, steps, step)
    force_noise = config.unit.force_sigma * draws("force").standard_normal((steps, 3))
    rate_noise = np.deg2rad(config.unit.rate_sigma) * draws("rate").standard_normal((steps, 3))

    due = np.arange(steps) % round(config.record.rate / sensors.fix_rate) == 0
    direction = draws("lever").standard_normal(3)
    antennas = ANTENNAS.copy()
    antennas[0] += cell["lever"] * direction / np.linalg.norm(direction)
    fixes = motion.locate(antennas, time - cell["offset"])
    sigma = cell["sigma"] * np.array([1.0, 1.0, sensors.vertical])
    fixes += sigma * draws("fix").standard_normal((steps, len(ANTENNAS), 3))
    floating = np.zeros(steps, dtype=bool)
    added, floating[due] = draw_errors(sensors, draws, int(due.sum()))
    fixes[due] += added[:, None]
    fixes[~due | find_outages(config, cell["outage"])] = np.nan

    shown = _draw_prism_times(config, draws("prism_times"), steps * step)
    length = np.ptp(PRISMS[:, 0])
    prisms = motion.locate(PRISMS * [1.0 + sensors.stretch / length, 1.0, 1.0], shown)
    prisms += sensors.prism_sigma * draws("prisms").standard_normal(prisms.shape)
    return Measured(
        step=step,
        specific_force=truth.specific_force + force_bias + force_noise,
        rate=truth.rate + rate_bias + rate_noise,
        fixes=fixes,
        due=due,
        floating=floating,
        prism_times=shown + sensors.prism_offset,
        prisms=prisms,
        boom=None if truth.boom is None else measure_boom(config, draws, truth.boom),
    )


def draw_biases(unit: Unit, draws: Streams, steps: int, step: float) -> tuple[Array, Array]:
    """Return biases of accelerometers (m/s^2) and gyroscopes (rad/s), shape (steps, 3) each."""
    biases = []
    for name, size, walk in (
        ("force", unit.force_bias, unit.force_walk),
        ("rate", np.deg2rad(unit.rate_bias), np.deg2rad(unit.rate_walk)),
    ):
        begun = size * draws(f"{name}_bias").standard_normal(3)
        change = walk * np.sqrt(step / WALK_TIME)
        walked = np.cumsum(draws(f"{name}_walk").standard_normal((steps, 3)), axis=0)
        biases.append(begun + change * walked)
    return biases[0], biases[1]


def find_outages(config: BladeConfig, length: float) -> NDArray[np.bool_]:
    """Return which samples fall into an outage of GNSS, shape (steps,).

    Outages end at multiples of `sensors.outage_every` after the settling, the last one in time for
    the end of the record, in which the blade mates.
    """
    time, settled = _count_down(config)
    return np.asarray(settled & (time % config.sensors.outage_every < length))


def find_last_outage(config: BladeConfig, length: float) -> NDArray[np.bool_]:
    """Return the samples of the last outage, which are judged by the worst error, shape (steps,).

    Without an outage, they are as many as come between two.
    """
    time, settled = _count_down(config)
    return np.asarray(settled & (time < (length or config.sensors.outage_every)))


def _count_down(config: BladeConfig) -> tuple[Array, NDArray[np.bool_]]:
    """Return the time from each sample to the end, s, and whether it is past the settling."""
    sample = np.arange(config.record.steps)
    time = (config.record.steps - 1 - sample) / config.record.rate
    return time, sample >= config.record.settled


def _draw_prism_times(config: BladeConfig, draw: np.random.Generator, duration: float) -> Array:
    mean = 1.0 / config.sensors.prism_rate
    count = int(duration / mean / (1.0 - IRREGULAR)) + 2
    times = np.cumsum(mean * (1.0 + IRREGULAR * draw.uniform(-1.0, 1.0, count))) - 0.5 * mean
    return np.asarray(times[times < duration - 0.5 * mean])


def draw_errors(sensors: Sensors, draws: Streams, count: int) -> tuple[Array, NDArray[np.bool_]]:
    """Draw the errors of successive fixes, m, (count, 3), and which are float solutions, (count,).

    All antennas of a record suffer these errors alike: they hear the same sky. The processes are
    usual models, not measured ones; Maes et al. (2018) say nothing about errors but their size.
    Lost fixes are counted.
    """
    receiver, interval, errors = sensors.receiver, 1.0 / sensors.fix_rate, np.zeros((count, 3))
    floating = draw_states(receiver, draws("float"), count, interval)
    slow = partial(draw_gauss_markov, time=receiver.red_time, step=interval, axes=3)
    if receiver.red_sigma > 0.0:
        errors += slow(draws("red"), count, sigma=receiver.red_sigma)
    if floating.any():
        drawn = slow(draws("float_error"), count, sigma=receiver.float_sigma)
        errors += np.where(floating[:, None], drawn, 0.0)
    if receiver.jump_every is not None:
        errors += draw_outliers(
            draws("jumps"),
            draws("jump_offsets"),
            count,
            rate=min(receiver.jump_time / receiver.jump_every, 0.5),
            sigma=receiver.jump_sigma,
            length=max(round(receiver.jump_time / interval), 1),
            axes=3,
        )
    return errors * [1.0, 1.0, sensors.vertical], floating


def draw_states(
    receiver: Receiver, draw: np.random.Generator, count: int, interval: float
) -> NDArray[np.bool_]:
    """Return at which fixes the solution is float, shape (count,).

    A record begins with a fixed solution. The times of both states are exponentially distributed.
    """
    floating = np.zeros(count, dtype=bool)
    if receiver.fixed_time is None:
        return floating
    time = draw.exponential(receiver.fixed_time)
    while time < count * interval:
        end = time + draw.exponential(receiver.float_time)
        floating[int(np.ceil(time / interval)) : int(np.ceil(end / interval))] = True
        time = end + draw.exponential(receiver.fixed_time)
    return floating
