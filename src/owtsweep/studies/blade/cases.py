"""Records of a cell, simulated or recorded: truth, what sensors say, how they begin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.blade.believed import believe, draw_start, find_start_sigma
from owtsweep.studies.blade.case import Conditions
from owtsweep.studies.blade.contract import PLAN, Geometry, Measured, Setting, Truth
from owtsweep.studies.blade.measuring import find_outages, measure
from owtsweep.studies.blade.recorded_case import find_reference, load_lift
from owtsweep.studies.blade.truth import make_truth

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


def make_cases(
    config: BladeConfig, conditions: Conditions, replicates: Sequence[int]
) -> list[Case]:
    """Return records of a cell.

    Raises
    ------
    InputError
        If a recorded lift cannot be used.
    """
    if config.recorded.imu is not None:
        return [_take_lift(config, conditions)]
    cases = []
    for replicate in replicates:
        motion = make_truth(config, replicate, conditions)
        measured = measure(config, motion, conditions, replicate)
        start = draw_start(config, motion, replicate)
        cases.append(Case(motion.truth, measured, start, find_start_sigma(config), PLAN))
    return cases


def _take_lift(config: BladeConfig, conditions: Conditions) -> Case:
    """Return a recorded lift; fixes are withheld in outages."""
    lift = load_lift(config)
    hidden = find_outages(config, conditions.outage)[:, None, None]
    fixes = lift.measured.fixes
    return Case(
        find_reference(config, lift),
        replace(lift.measured, fixes=np.where(hidden, np.nan, fixes)),
        lift.start,
        lift.start_sigma,
        config.recorded.geometry,
        np.where(hidden, fixes, np.nan)[:, 0],
    )
