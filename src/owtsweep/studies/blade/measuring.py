"""What the sensors of a record say: inertial unit, GNSS with outages and a clock, total stations.

Random numbers have streams of their own, so that a larger noise, a longer outage or another offset
are the same draws enlarged.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.streams import stream
from owtsweep.studies.blade.boom import measure_boom
from owtsweep.studies.blade.case import Conditions
from owtsweep.studies.blade.contract import ANTENNAS, PRISMS, Measured
from owtsweep.studies.blade.receiver import draw_errors
from owtsweep.studies.blade.truth import Motion

if TYPE_CHECKING:
    from owtsweep.studies.blade.config import BladeConfig
    from owtsweep.studies.blade.sections import Unit

#: Time in s after which a walk of a bias is what the configuration says.
WALK_TIME = 100.0
#: Total stations report at irregular times: their intervals differ by up to this part.
IRREGULAR = 0.3


def measure(
    config: BladeConfig, motion: Motion, conditions: Conditions, replicate: int
) -> Measured:
    """Return what the sensors say of a record under conditions."""
    draws = partial(stream, config.seed, config.study, (), replicate)
    truth, sensors = motion.truth, config.sensors
    steps, step = len(truth.rate), truth.step
    time = step * np.arange(steps)
    force_bias, rate_bias = draw_biases(config.unit, draws, steps, step)
    force_noise = config.unit.force_sigma * draws("force").standard_normal((steps, 3))
    rate_noise = np.deg2rad(config.unit.rate_sigma) * draws("rate").standard_normal((steps, 3))

    due = find_due(config)
    direction = draws("lever").standard_normal(3)
    antennas = ANTENNAS.copy()
    antennas[0] += conditions.lever * direction / np.linalg.norm(direction)
    fixes = motion.locate(antennas, time - conditions.offset)
    sigma = conditions.sigma * np.array([1.0, 1.0, sensors.vertical])
    fixes += sigma * draws("fix").standard_normal((steps, len(ANTENNAS), 3))
    interval, floating = 1.0 / sensors.fix_rate, np.zeros(steps, dtype=bool)
    added, floating[due] = draw_errors(
        sensors.receiver, draws, int(due.sum()), interval, sensors.vertical
    )
    fixes[due] += added[:, None]
    fixes[~due | find_outages(config, conditions.outage)] = np.nan

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
        boom=None if truth.boom is None else measure_boom(config, truth.boom, replicate),
    )


def draw_biases(
    unit: Unit, draws: partial[np.random.Generator], steps: int, step: float
) -> tuple[Array, Array]:
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


def find_due(config: BladeConfig) -> NDArray[np.bool_]:
    """Return at which samples a fix is due, shape (steps,)."""
    every = round(config.record.rate / config.sensors.fix_rate)
    return np.asarray(np.arange(config.record.steps) % every == 0)


def find_outages(config: BladeConfig, length: float) -> NDArray[np.bool_]:
    """Return which samples fall into an outage of GNSS, shape (steps,).

    Outages end at multiples of `sensors.outage_every` after the settling, the last one in time for
    the end of the record, in which the blade mates.
    """
    record, every = config.record, config.sensors.outage_every
    before_end = (record.steps - 1 - np.arange(record.steps)) / record.rate
    settled = np.arange(record.steps) >= record.settled
    return np.asarray(settled & (before_end % every < length))


def find_last_outage(config: BladeConfig, length: float) -> NDArray[np.bool_]:
    """Return which samples are judged by the worst error, shape (steps,).

    Those of the last outage, or, without one, as many as come between two.
    """
    record = config.record
    before_end = (record.steps - 1 - np.arange(record.steps)) / record.rate
    judged = length if length > 0.0 else config.sensors.outage_every
    settled = np.arange(record.steps) >= record.settled
    return np.asarray(settled & (before_end < judged))


def _draw_prism_times(config: BladeConfig, draw: np.random.Generator, duration: float) -> Array:
    """Return the times in s at which total stations measure, within the record."""
    mean = 1.0 / config.sensors.prism_rate
    count = int(duration / mean / (1.0 - IRREGULAR)) + 2
    times = np.cumsum(mean * (1.0 + IRREGULAR * draw.uniform(-1.0, 1.0, count))) - 0.5 * mean
    return np.asarray(times[times < duration - 0.5 * mean])
