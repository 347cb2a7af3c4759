"""UKF and INVARIANT_EKF: filters of the states of MEKF that linearise otherwise.

UKF is the unscented Kalman filter on 15 errors, what the paper's system runs (section 2.1).
INVARIANT_EKF is the left-invariant extended Kalman filter with biases.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from scipy.spatial.transform import Rotation

from owtsweep.arrays import Array
from owtsweep.estimation.inertial.invariant import filter_invariant
from owtsweep.estimation.inertial.strapdown import ERRORS
from owtsweep.estimation.inertial.unscented import filter_unscented
from owtsweep.studies.base.schemes import ByFunction
from owtsweep.studies.blade.contract import Direct, Estimates, Measured, Setting
from owtsweep.studies.blade.schemes.navigation import Found, begin, make_record, make_room, report


def run_unscented(setting: Setting, measured: Measured) -> Estimates:
    """Run the unscented filter on a record."""
    found = _filter(filter_unscented, setting, measured, begin(setting))
    return report(setting, measured, found)


def run_invariant(setting: Setting, measured: Measured) -> Estimates:
    """Run the invariant filter on a record."""
    s, P = begin(setting)
    turn = _turn_errors(s[None])[0]
    found = _filter(filter_invariant, setting, measured, (s, turn.T @ P @ turn))
    turn = _turn_errors(found.states)
    at_rest = turn @ found.covariances @ turn.transpose(0, 2, 1)
    return report(setting, measured, found._replace(covariances=at_rest))


def _filter(
    run: Callable[..., None], setting: Setting, measured: Measured, start: tuple[Array, Array]
) -> Found:
    """Run a filter of `estimation` on the fixes of the first antenna."""
    found = make_room(measured)
    run(make_record(setting, measured), start, tuple(found))
    return found


def _turn_errors(states: Array) -> Array:
    """Return by what errors in the body's frame become those of `strapdown`, (steps, 15, 15)."""
    turn = np.tile(np.eye(ERRORS), (len(states), 1, 1))
    rotation = Rotation.from_quat(states[:, 6:10], scalar_first=True).as_matrix()
    turn[:, :3, :3] = turn[:, 3:6, 3:6] = rotation
    return turn


UKF = Direct("UKF", partial(ByFunction, run_unscented))
INVARIANT_EKF = Direct("INVARIANT_EKF", partial(ByFunction, run_invariant))
