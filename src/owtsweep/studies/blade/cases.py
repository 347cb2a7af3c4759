"""Records of a cell, simulated or recorded: truth, what sensors say, how they begin."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.blade.believed import believe, draw_start, find_start_sigma
from owtsweep.studies.blade.case import Conditions
from owtsweep.studies.blade.contract import PLAN, Geometry, Measured, Setting, Truth
from owtsweep.studies.blade.measuring import find_outages, measure
from owtsweep.studies.blade.recorded_case import Lift, find_reference, load_lift
from owtsweep.studies.blade.truth import Motion, make_truth

if TYPE_CHECKING:
    from owtsweep.studies.blade.config import BladeConfig


class Case(NamedTuple):
    """One record of a cell.

    Attributes
    ----------
    truth
        The motion; of a recorded lift the estimates of the smoother with all fixes.
    measured
        What the sensors say.
    start, start_sigma, geometry
        As of `contract.Setting`.
    withheld
        Fixes of the first antenna that a record has and `measured` has not, m, shape (steps, 3),
        NaN at other samples; None if the lift is simulated.
    """

    truth: Truth
    measured: Measured
    start: tuple[Array, Array]
    start_sigma: Array
    geometry: Geometry
    withheld: Array | None = None

    def tell(self, config: BladeConfig, conditions: Conditions) -> Setting:
        """Return what schemes know of the case, by the tuning of a configuration."""
        return believe(config, conditions, self.start, self.start_sigma, self.geometry)


class World(NamedTuple):
    """What moves in a record: a simulated blade, or the one of a recorded lift.

    Attributes
    ----------
    replicate
        Number of the record.
    motion
        The simulated motion; None if the lift is recorded.
    lift, reference
        The recorded lift, and what stands for its truth; None if the lift is simulated.
    """

    replicate: int
    motion: Motion | None = None
    lift: Lift | None = None
    reference: Truth | None = None


def make_world(config: BladeConfig, conditions: Conditions, replicate: int) -> World:
    """Simulate the motion of a record, or read the recorded lift.

    Raises
    ------
    InputError
        If a recorded lift cannot be used.
    """
    if config.recorded.imu is None:
        return World(replicate, make_truth(config, replicate, conditions))
    lift = load_lift(config)
    return World(replicate, lift=lift, reference=find_reference(config, lift))


def observe(config: BladeConfig, conditions: Conditions, world: World) -> Case:
    """Return the record of a cell; fixes of a recorded lift are withheld in outages."""
    if world.motion is not None:
        measured = measure(config, world.motion, conditions, world.replicate)
        start = draw_start(config, world.motion, world.replicate)
        return Case(world.motion.truth, measured, start, find_start_sigma(config), PLAN)
    lift = world.lift
    assert lift is not None
    assert world.reference is not None
    hidden = find_outages(config, conditions.outage)[:, None, None]
    fixes = lift.measured.fixes
    return Case(
        world.reference,
        replace(lift.measured, fixes=np.where(hidden, np.nan, fixes)),
        lift.start,
        lift.start_sigma,
        config.recorded.geometry,
        np.where(hidden, fixes, np.nan)[:, 0],
    )
