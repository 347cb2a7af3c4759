"""Records of a cell, simulated or recorded: truth, what sensors say, and what schemes know."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from owtsweep.arrays import Array
from owtsweep.studies.base.axes import Cell
from owtsweep.studies.blade.config import BladeConfig
from owtsweep.studies.blade.contest import CONTEST
from owtsweep.studies.blade.contract import Measured, Setting, Start, Truth
from owtsweep.studies.blade.measuring import WALK_TIME, find_outages, measure
from owtsweep.studies.blade.recorded_case import Lift, find_reference, load_lift
from owtsweep.studies.blade.truth import Motion, choose_freedoms, make_truth

#: A bias or a walk of zero is assumed to be this part of the noise of a sample, so that its
#: variance stays positive.
LEAST = 1e-6


class Case(NamedTuple):
    """One record of a cell.

    `truth`: the motion; of a recorded lift the estimates of the smoother with all fixes.
    `withheld`: fixes of the first antenna that a record has and `measured` has not, m, shape
    (steps, 3), NaN at other samples; None if the lift is simulated.
    """

    truth: Truth
    measured: Measured
    start: Start
    withheld: Array | None = None


#: A recorded lift, and the reference that stands for its truth.
RecordedMotion = tuple[Lift, Truth]


def make_world(config: BladeConfig, cell: Cell, replicate: int) -> Motion | RecordedMotion:
    """Simulate the motion of a record, or read the recorded lift.

    Raise `InputError` if a recorded lift cannot be used.
    """
    if config.recorded.imu is None:
        return make_truth(config, replicate, cell)
    lift = load_lift(config)
    return lift, find_reference(lift, make_lift_setting(config, lift))


def observe(config: BladeConfig, cell: Cell, world: Motion | RecordedMotion) -> Case:
    """Return the record of a cell; fixes of a recorded lift are withheld in outages."""
    if isinstance(world, Motion):
        return Case(world.truth, measure(config, world, cell), draw_start(config, world))
    lift, reference = world
    hidden = find_outages(config, cell["outage"])[:, None, None]
    fixes = lift.measured.fixes
    return Case(
        reference,
        replace(lift.measured, fixes=np.where(hidden, np.nan, fixes)),
        lift.start,
        np.where(hidden, fixes, np.nan)[:, 0],
    )


def make_setting(config: BladeConfig, cell: Cell, start: Start) -> Setting:
    """Return what schemes know of a case with a start, by the section `filters`."""
    tuning, sensors = config.filters, config.sensors
    receiver = sensors.receiver
    vertical = np.array([1.0, 1.0, sensors.vertical])
    declared = tuning.noise == "declared"
    priors = tuning if declared else config.unit
    fix_sigma = np.array(tuning.fix_sigma) if declared else cell["sigma"] * vertical
    walk = 1.0 / np.sqrt(WALK_TIME)
    rate_sigma = np.deg2rad(priors.rate_sigma)
    return Setting(
        step=1.0 / config.record.rate,
        fix_sigma=fix_sigma,
        float_sigma=fix_sigma if declared else np.hypot(fix_sigma, receiver.float_sigma * vertical),
        force_sigma=priors.force_sigma,
        rate_sigma=rate_sigma,
        force_bias=max(priors.force_bias, LEAST * priors.force_sigma),
        rate_bias=max(np.deg2rad(priors.rate_bias), LEAST * rate_sigma),
        force_walk=walk * priors.force_walk,
        rate_walk=walk * np.deg2rad(priors.rate_walk),
        start=start.pose,
        start_sigma=start.sigma,
        offset_sigma=tuning.offset_sigma,
        lever_sigma=tuning.lever_sigma,
        swing=tuple(choose_freedoms(config, cell).values())[:3],
        gust_time=config.motion.gust_time,
        tuning=tuning,
        geometry=start.geometry,
    )


def make_lift_setting(config: BladeConfig, lift: Lift) -> Setting:
    """Return what schemes know of a recorded lift, at the grid's first cell."""
    return make_setting(config, CONTEST.list_cells(config)[0], lift.start)


def draw_start(config: BladeConfig, motion: Motion) -> Start:
    """Draw the given start of a record.

    The error of the attitude turns the body: about x and y by the tilt's, about z by the heading's.
    """
    draw = config.draws(motion.replicate)("start").standard_normal((3, 3))
    truth, sensors, unit = motion.truth, config.sensors, config.unit
    tilt, heading = np.deg2rad([unit.tilt, unit.heading])
    sigma = np.array([sensors.start_position, sensors.start_velocity, tilt, heading])
    given = np.stack([truth.unit[0], truth.unit_velocity[0]]) + sigma[:2, None] * draw[:2]
    turn = Rotation.from_rotvec(np.array([tilt, tilt, heading]) * draw[2]).as_matrix()
    return Start((given, truth.rotation[0] @ turn), sigma)
