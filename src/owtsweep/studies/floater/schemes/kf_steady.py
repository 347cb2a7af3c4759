"""KF_STEADY: the steady-state Kalman predictor of Mehammer et al. (2018), Eqs. (16) to (18).

Its gain does not change, so it cannot leave out a loss that arrives as zeros. `printed` says what
is corrected.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.kinematic_predictor import make_transition, predict_steady, solve_steady
from owtsweep.studies.base.contract import Unable
from owtsweep.studies.floater.contract import DOF, Estimates, Measured, Scheme, Setting
from owtsweep.studies.floater.schemes.linear import read_inputs
from owtsweep.studies.floater.schemes.printed import (
    begin,
    output_noise,
    predict_ahead,
    process_noise,
)


@dataclass(frozen=True)
class SteadyPredictor:
    """The predictor with its gains and covariances, shape (6, 2, 2) each."""

    setting: Setting
    gain: Array
    covariance: Array

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record."""
        position, acceleration, rate = read_inputs(self.setting, measured)
        estimate = np.empty((*position.shape, 2))
        nis = np.empty(position.shape)
        variance = self.covariance[:, 0, 0] + self.setting.position_sigma**2
        for i, start in enumerate(begin(self.setting, position)[0]):
            predict_steady(
                position[i], acceleration[i], rate[i], measured.step, self.gain[i], variance[i],
                start, (estimate[i], nis[i]),
            )  # fmt: skip
        predict_ahead(self.setting, estimate, acceleration)
        return Estimates(
            np.ascontiguousarray(estimate[:, :, 0].T),
            np.ascontiguousarray(estimate[:, :, 1].T),
            self.covariance[None],
            nis.T,
        )


class KfSteady(Scheme):
    """The steady-state predictor as printed."""

    name = "KF_STEADY"

    def prepare(self, setting: Setting) -> SteadyPredictor:
        """Compute the gains for a setting.

        Raises
        ------
        Unable
            If there is no steady state.
        """
        A = make_transition(setting.step)
        gain, covariance = np.zeros((len(DOF), 2, 2)), np.empty((len(DOF), 2, 2))
        for i, Q in enumerate(process_noise(setting)):
            R = output_noise(setting, i)
            try:
                K, covariance[i] = solve_steady(A, np.eye(2)[: len(R)], Q, np.diag(R))
            except np.linalg.LinAlgError:
                raise Unable(
                    f"{self.name} has no steady state: it believes that the acceleration of "
                    f"{DOF[i]} has no noise"
                ) from None
            gain[i, :, : len(R)] = K
        return SteadyPredictor(setting, gain, covariance)


SCHEME = KfSteady()
