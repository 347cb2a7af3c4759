"""What schemes are told of a case: noise, biases, how a record begins, how the hook swings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import Rotation

from owtsweep.arrays import Array
from owtsweep.streams import stream
from owtsweep.studies.blade.case import Conditions
from owtsweep.studies.blade.contract import PLAN, Geometry, Setting
from owtsweep.studies.blade.measuring import WALK_TIME
from owtsweep.studies.blade.truth import Motion, choose_freedoms

if TYPE_CHECKING:
    from owtsweep.studies.blade.config import BladeConfig

#: A bias or a walk of zero is believed to be this part of the noise of a sample, so that its
#: variance stays positive.
LEAST = 1e-6


def make_setting(
    config: BladeConfig, motion: Motion, conditions: Conditions, replicate: int
) -> Setting:
    """Return what schemes know beforehand of a simulated case, by the section `filters`."""
    start = draw_start(config, motion, replicate)
    return believe(config, conditions, start, find_start_sigma(config))


def believe(
    config: BladeConfig,
    conditions: Conditions,
    start: tuple[Array, Array],
    start_sigma: Array,
    geometry: Geometry = PLAN,
) -> Setting:
    """Return what schemes know of a case that begins at `start`, by the section `filters`.

    `start`, `start_sigma` and `geometry` are those of `contract.Setting`.
    """
    tuning, sensors = config.filters, config.sensors
    receiver = sensors.receiver
    told = tuning if tuning.noise == "declared" else config.unit
    vertical = np.array([1.0, 1.0, sensors.vertical])
    declared = tuning.noise == "declared"
    fix_sigma = np.array(tuning.fix_sigma) if declared else conditions.sigma * vertical
    freedoms = list(choose_freedoms(config, conditions).values())[:3]
    walk = 1.0 / np.sqrt(WALK_TIME)
    rate_sigma = np.deg2rad(told.rate_sigma)
    return Setting(
        step=1.0 / config.record.rate,
        fix_sigma=fix_sigma,
        float_sigma=fix_sigma if declared else np.hypot(fix_sigma, receiver.float_sigma * vertical),
        force_sigma=told.force_sigma,
        rate_sigma=rate_sigma,
        force_bias=max(told.force_bias, LEAST * told.force_sigma),
        rate_bias=max(np.deg2rad(told.rate_bias), LEAST * rate_sigma),
        force_walk=walk * told.force_walk,
        rate_walk=walk * np.deg2rad(told.rate_walk),
        start=start,
        start_sigma=start_sigma,
        offset_sigma=tuning.offset_sigma,
        lever_sigma=tuning.lever_sigma,
        swing_sigma=np.array([sigma for _, _, sigma, _ in freedoms]),
        swing_period=np.array([period for period, _, _, _ in freedoms]),
        swing_damping=np.array([damping for _, damping, _, _ in freedoms]),
        gust_sigma=np.array([gust for _, _, _, gust in freedoms]),
        gust_time=config.motion.gust_time,
        tuning=tuning,
        geometry=geometry,
    )


def find_start_sigma(config: BladeConfig) -> Array:
    """Return errors of the start: position (m), velocity (m/s), tilt and heading (rad)."""
    sensors, unit = config.sensors, config.unit
    tilt, heading = np.deg2rad([unit.tilt, unit.heading])
    return np.array([sensors.start_position, sensors.start_velocity, tilt, heading])


def draw_start(config: BladeConfig, motion: Motion, replicate: int) -> tuple[Array, Array]:
    """Draw the given position and velocity (2, 3) and attitude (3, 3) of a record's first sample.

    The error of the attitude turns the body: about x and y by the tilt's, about z by the heading's.
    """
    draw = stream(config.seed, config.study, (), replicate, "start").standard_normal((3, 3))
    position, velocity, tilt, heading = find_start_sigma(config)
    truth = motion.truth
    given = np.stack([
        truth.unit[0] + position * draw[0], truth.unit_velocity[0] + velocity * draw[1]
    ])  # fmt: skip
    turn = Rotation.from_rotvec(np.array([tilt, tilt, heading]) * draw[2]).as_matrix()
    return given, truth.rotation[0] @ turn
