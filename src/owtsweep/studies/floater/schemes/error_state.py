"""ERROR_STATE: an error-state Kalman filter with a quaternion attitude, for large angles.

Its noise is that of KF_REPAIRED: white noise of accelerations, a bias that wanders, angular
accelerations that are nothing but noise, and reports of a known age. But specific force is turned
by the estimated attitude, whose error the covariance knows.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from owtsweep.arrays import Array
from owtsweep.estimation.inertial.reports import filter_body
from owtsweep.estimation.inertial.strapdown import STATES
from owtsweep.estimation.kinematic_filter import snap
from owtsweep.studies.base.schemes import ByFunction, Unable
from owtsweep.studies.floater.contract import DOF, Direct, Estimates, Measured, Setting
from owtsweep.studies.floater.schemes.linear import find_age, keep_reports


def navigate(setting: Setting, measured: Measured) -> Estimates:
    """Estimate from the measurements of a record."""
    steps = len(measured.position)
    reported = np.ascontiguousarray(keep_reports(setting, measured))
    shown = snap(np.arange(steps) - find_age(setting, measured) / measured.step)
    noise = np.stack(
        [
            setting.acceleration_sigma[:3] ** 2 * measured.step,
            setting.acceleration_sigma[3:] ** 2 * measured.step,
            setting.bias_walk[:3] ** 2,
        ]
    )
    found = (
        np.zeros((steps, len(DOF))),
        np.zeros((steps, len(DOF))),
        np.tile(setting.motion_sigma[:2].T[:, :, None] ** 2 * np.eye(2), (steps, 1, 1, 1)),
        np.full((steps, len(DOF)), np.nan),
    )
    usable = np.isfinite(reported).all(axis=1) & (shown >= 0.0) & (shown <= np.arange(steps))
    if usable.any():
        first = int(np.argmax(usable))
        found[0][:first] = reported[first]
        filter_body(
            reported, shown, measured.specific_force, measured.rate, measured.step, noise,
            (setting.position_sigma**2, setting.rate_sigma**2), first,
            _begin(setting, reported[first]), found,
        )  # fmt: skip
    return Estimates(*found)


def _begin(setting: Setting, report: Array) -> tuple[Array, Array]:
    """Return state and covariance at the first report, at rest, without a bias."""
    state = np.zeros(STATES)
    state[:3] = report[:3]
    state[6:10] = Rotation.from_euler("ZYX", report[:2:-1]).as_quat(scalar_first=True)
    sigma = np.concatenate(
        [
            setting.position_sigma[:3], setting.motion_sigma[1, :3],
            setting.position_sigma[3:], setting.bias_sigma[:3], setting.motion_sigma[1, 3:],
        ]
    )  # fmt: skip
    return state, np.diag(sigma**2)


def prepare(setting: Setting) -> ByFunction[Setting, Measured, Estimates]:
    """Make the filter ready for a setting; `Unable` if sensors are not fixed to the body."""
    if not setting.body:
        raise Unable(
            "ERROR_STATE needs specific force and rates of the body: use sensors.frame=body"
        )
    return ByFunction(navigate, setting)


SCHEME = Direct("ERROR_STATE", prepare)
