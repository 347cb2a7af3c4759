"""INVARIANT_EKF: the left-invariant extended Kalman filter with biases."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from owtsweep.arrays import Array
from owtsweep.estimation.inertial import ERRORS
from owtsweep.estimation.inertial_invariant import filter_invariant
from owtsweep.studies.blade.contract import Direct, Estimates, Measured, Setting
from owtsweep.studies.blade.schemes.navigation import (
    begin,
    find_noise,
    find_variance,
    make_room,
    report,
)


@dataclass(frozen=True)
class Invariant:
    """The filter, made ready for a setting."""

    setting: Setting

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record."""
        found = make_room(measured)
        s, P = begin(self.setting)
        turn = _turn_errors(s[None])[0]
        filter_invariant(
            measured.fixes[:, :1].copy(), self.setting.geometry.levers[:1],
            find_variance(self.setting, measured), measured.due, measured.specific_force,
            measured.rate, measured.step, find_noise(self.setting),
            (s, turn.T @ P @ turn), tuple(found),
        )  # fmt: skip
        turn = _turn_errors(found.states)
        at_rest = turn @ found.covariances @ turn.transpose(0, 2, 1)
        return report(self.setting, measured, found._replace(covariances=at_rest))


def _turn_errors(states: Array) -> Array:
    """Return by what errors in the body's frame become those of `inertial`, (steps, 15, 15)."""
    turn = np.tile(np.eye(ERRORS), (len(states), 1, 1))
    rotation = Rotation.from_quat(states[:, 6:10], scalar_first=True).as_matrix()
    turn[:, :3, :3] = turn[:, 3:6, 3:6] = rotation
    return turn


SCHEME = Direct("INVARIANT_EKF", Invariant)
