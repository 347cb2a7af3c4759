"""The consistent linear Kalman filters (KF_CONSISTENT to FIXED_LAG), and what KF shares with them.

What they have otherwise than the printed predictors (`printed`): noise of a measured acceleration
enters the velocity alone, at all its frequencies alike; the acceleration goes linearly from sample
to sample, where KF holds it and so takes velocities half a step late; and the estimate of a sample
knows its report.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.inertial.angles import find_angle_rates, make_rotation
from owtsweep.estimation.kinematic import Noise
from owtsweep.estimation.kinematic_filter import Found, Record, filter_all, smooth_all, snap
from owtsweep.gravity import GRAVITY
from owtsweep.sensing.faults import hold_last
from owtsweep.studies.floater.contract import DOF, Direct, Estimates, Measured, Setting

#: The degrees of freedom whose rates are measured: the angles (Eq. 5, matrix C).
ANGLES = range(3, 6)
_NONE = np.empty(0)


@dataclass(frozen=True)
class Linear:
    """A filter of all degrees of freedom, made ready for one setting.

    With `bias` a bias of each acceleration is a state; with `delay` the time that a report shows
    counts; with `lagged` there is a smoother, whose latency is `filters.lag`. A delay of the
    optical system eats up the lag: with a delay of the lag, the smoother is the filter without
    delay, an interval late; with a longer one, it predicts by what is left.
    """

    setting: Setting
    bias: bool
    delay: bool
    lagged: bool = False

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record."""
        setting = self.setting
        age = find_age(setting, measured) if self.delay else 0.0
        record = read_inputs(setting, measured, age)
        bias, walk = self.bias * setting.bias_sigma, self.bias * setting.bias_walk
        noises = make_noises(setting, walk)
        prior = np.column_stack([*setting.motion_sigma[:2], bias])
        if not self.lagged:
            return report(filter_all(record, noises, prior))
        lag = round(setting.tuning.lag / measured.step)
        return report(smooth_all(record, noises, prior, lag), latency=lag * measured.step)


def part_columns(estimate: Array) -> tuple[Array, Array]:
    """Return positions and velocities, (steps, 6) each, of estimates (6, steps, 2)."""
    return np.ascontiguousarray(estimate[:, :, 0].T), np.ascontiguousarray(estimate[:, :, 1].T)


def report(found: Found, latency: float = 0.0) -> Estimates:
    """Return what a filter found, columns last."""
    return Estimates(
        *part_columns(found.estimate),
        covariance=found.covariance.transpose(1, 0, 2, 3),
        nis=found.nis.T,
        latency=latency,
    )


def keep_reports(setting: Setting, measured: Measured) -> Array:
    """Return reported positions, shape (steps, 6), NaN where a scheme that knows of losses looks.

    A scheme that does not know takes zeros as they are.
    """
    if setting.tuning.losses == "known":
        return np.where(measured.lost[:, None], np.nan, measured.position)
    return measured.position


def find_age(setting: Setting, measured: Measured) -> Array:
    """Return the assumed ages of reports in s, shape (steps,).

    Schemes that know the truth have each report's time stamp; else all reports are equally old.
    """
    if setting.tuning.delay == "truth":
        return measured.age
    return np.full(len(measured.age), setting.delay)


def read_inputs(setting: Setting, measured: Measured, age: Array | float = 0.0) -> Record:
    """Return what a scheme takes of a record whose reports have an `age` in s, (steps,) or one.

    Body-fixed sensors measure no accelerations of angles: these are 0 (section 2.2). What they
    measure is turned by the last reported attitude (section 3.2), or counts as that of the basin's
    frame (section 2.3), as `filters.attitude` says.
    """
    reported = keep_reports(setting, measured)
    acceleration, rate = measured.acceleration, measured.rate
    if measured.specific_force is not None:
        how, angles = setting.tuning.attitude, hold_last(reported, 0.0)[:, 3:]
        acceleration = np.zeros(reported.shape)
        acceleration[:, :3] = level(measured.specific_force, angles, how)
        if how == "reported":
            rate = find_angle_rates(angles, rate)
    assert acceleration is not None
    return Record(
        np.ascontiguousarray(reported.T),
        snap(np.arange(len(reported)) - age / measured.step),
        np.ascontiguousarray(acceleration.T),
        [_NONE] * 3 + [np.ascontiguousarray(column) for column in rate.T],
        measured.step,
    )


def level(force: Array, angles: Array, how: Literal["level", "small", "reported"]) -> Array:
    """Return accelerations of the translations in m/s^2, shape (steps, 3).

    force: Specific force in the body's frame, m/s^2, shape (steps, 3).
    angles: Euler angles in rad, shape (steps, 3).
    how: "reported": it is turned by the angles. "small": only gravity is, to first order. "level":
        it counts as the acceleration without gravity.
    """
    found = force.copy()
    if how == "small":
        found[:, 0] -= GRAVITY * angles[:, 1]
        found[:, 1] += GRAVITY * angles[:, 0]
    elif how == "reported":
        found = np.einsum("nij,nj->ni", make_rotation(angles), found)
    found[:, 2] += GRAVITY
    return found


def make_noises(setting: Setting, walk: Array) -> list[Noise]:
    """Return the noise of each degree of freedom; `walk` is the change of its bias, shape (6,)."""
    acceleration = setting.acceleration_sigma**2
    if setting.body and setting.tuning.attitude != "level":
        # Noise of the reported attitude tilts gravity: pitch into surge, roll into sway.
        acceleration = acceleration.copy()
        acceleration[:2] += (GRAVITY * setting.position_sigma[[4, 3]]) ** 2
    return [
        Noise(
            float(acceleration[i] * setting.step),
            float(walk[i] ** 2),
            float(setting.position_sigma[i] ** 2),
            float(setting.rate_sigma[i - 3] ** 2) if i in ANGLES else 1.0,
        )
        for i in range(len(DOF))
    ]


KF_CONSISTENT = Direct("KF_CONSISTENT", partial(Linear, bias=False, delay=False))
KF_BIAS = Direct("KF_BIAS", partial(Linear, bias=True, delay=False))
KF_DELAY = Direct("KF_DELAY", partial(Linear, bias=False, delay=True))
KF_REPAIRED = Direct("KF_REPAIRED", partial(Linear, bias=True, delay=True))
FIXED_LAG = Direct("FIXED_LAG", partial(Linear, bias=True, delay=True, lagged=True))
