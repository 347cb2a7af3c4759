"""KF_STEADY and KF: the predictors of Mehammer et al. (2018), steady (Eqs. 16-18) or not (11-14).

As printed and as the author's code has it, but for what cannot have been meant: process noise v_1
enters by the right G_d (Eq. 9 prints I), and the Riccati step is that of Eq. (14) (the code lacks
C P there). So both: noise of the size of accelerations drives positions as well as velocities, and
the estimate of a sample knows the reports before it.

With filters.losses=as_printed, KF multiplies R by 1e20 where all six reported positions are exactly
zero, as the author's code does. (There, the factors of a loss also accumulate, up to infinity; that
is left out.) The gain of KF_STEADY does not change, so it cannot leave out a loss.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.kinematic_predictor import (
    make_noise,
    make_transition,
    predict_steady,
    predict_varying,
    solve_steady,
)
from owtsweep.studies.base.schemes import ByFunction, Unable
from owtsweep.studies.floater.contract import DOF, Direct, Estimates, Measured, Setting
from owtsweep.studies.floater.schemes.linear import ANGLES, part_columns, read_inputs

#: By what R is multiplied in a loss.
LOSS = 1e20


@dataclass(frozen=True)
class SteadyPredictor:
    """The predictor with its gains and covariances, shape (6, 2, 2) each."""

    setting: Setting
    gain: Array
    covariance: Array

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record."""
        position, _, acceleration, rate, step = read_inputs(self.setting, measured)
        estimate = np.empty((*position.shape, 2))
        nis = np.empty(position.shape)
        variance = self.covariance[:, 0, 0] + self.setting.position_sigma**2
        for i, start in enumerate(begin(self.setting, position)[0]):
            predict_steady(
                position[i], acceleration[i], rate[i], step, self.gain[i], variance[i], start,
                (estimate[i], nis[i]),
            )  # fmt: skip
        predict_ahead(self.setting, estimate, acceleration)
        return Estimates(*part_columns(estimate), self.covariance[None], nis.T)


def prepare_steady(setting: Setting) -> SteadyPredictor:
    """Compute the gains of KF_STEADY for a setting; `Unable` if there is no steady state."""
    A = make_transition(setting.step)
    gain, covariance = np.zeros((len(DOF), 2, 2)), np.empty((len(DOF), 2, 2))
    for i, Q in enumerate(process_noise(setting)):
        R = output_noise(setting, i)
        try:
            K, covariance[i] = solve_steady(A, np.eye(2)[: len(R)], Q, np.diag(R))
        except np.linalg.LinAlgError:
            raise Unable(
                "KF_STEADY has no steady state: it assumes that the acceleration of "
                f"{DOF[i]} has no noise"
            ) from None
        gain[i, :, : len(R)] = K
    return SteadyPredictor(setting, gain, covariance)


def predict_all(setting: Setting, measured: Measured) -> Estimates:
    """Predict with gains that vary from sample to sample."""
    position, _, acceleration, rate, step = read_inputs(setting, measured)
    factor = np.where(np.all(position == 0.0, axis=0), LOSS, 1.0)
    estimate, nis = np.empty((*position.shape, 2)), np.empty(position.shape)
    covariance = np.empty((*position.shape, 2, 2))
    start, before = begin(setting, position)
    for i, Q in enumerate(process_noise(setting)):
        R = output_noise(setting, i)
        predict_varying(
            position[i], acceleration[i], rate[i], step, Q, np.resize(R, 2), factor, start[i],
            before[i], (estimate[i], covariance[i], nis[i]),
        )  # fmt: skip
    predict_ahead(setting, estimate, acceleration)
    return Estimates(*part_columns(estimate), covariance.transpose(1, 0, 2, 3), nis.T)


def process_noise(setting: Setting) -> Array:
    """Return Q of Eq. (10) for each degree of freedom, shape (6, 2, 2).

    The author's v_1 has the size of the accelerations' noise in all 12 elements. With body-fixed
    sensors, angular accelerations are no inputs but process noise, and nothing else moves the
    angles (section 2.2).
    """
    sigma = np.column_stack([setting.acceleration_sigma] * 2)
    if setting.body:
        sigma[ANGLES, 0] = 0.0
    return np.stack([make_noise(setting.step, both) for both in sigma])


def predict_ahead(setting: Setting, estimate: Array, acceleration: Array) -> None:
    """Predict estimates by the declared delay of the reports that they rest on (section 3.2).

    Nothing is done unless `filters.delay` is "declared". `estimate`, positions and velocities (6,
    steps, 2), is overwritten; `acceleration` (6, steps) is held over the delay.
    """
    if setting.tuning.delay == "declared":
        ahead = setting.delay
        estimate[..., 0] += ahead * estimate[..., 1] + 0.5 * ahead**2 * acceleration
        estimate[..., 1] += ahead * acceleration


def output_noise(setting: Setting, column: int) -> Array:
    """Return the variances of the outputs of a degree of freedom: position, for angles the rate."""
    variances = [setting.position_sigma[column] ** 2]
    if column in ANGLES:
        variances.append(setting.rate_sigma[column - 3] ** 2)
    return np.array(variances)


def begin(setting: Setting, reported: Array) -> tuple[Array, Array]:
    """Return positions and velocities at sample 0, (6, 2), and their covariance, (6, 2, 2).

    That is the first report, at rest, or the truth, as in the paper's tests with virtual data.
    """
    if setting.start is not None:
        return np.ascontiguousarray(setting.start.T), np.zeros((len(DOF), 2, 2))
    sigmas = np.stack([setting.position_sigma, setting.motion_sigma[1]], axis=-1)
    return find_start(reported), sigmas[:, :, None] ** 2 * np.eye(2)


def find_start(reported: Array) -> Array:
    """Return positions and velocities at sample 0, (6, 2): the first report (6, steps), at rest."""
    there = np.all(np.isfinite(reported), axis=0)
    start = np.zeros((len(DOF), 2))
    if there.any():
        start[:, 0] = reported[:, np.argmax(there)]
    return start


KF_STEADY = Direct("KF_STEADY", prepare_steady)
KF = Direct("KF", partial(ByFunction, predict_all))
