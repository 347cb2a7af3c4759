"""KF: the time-varying Kalman predictor of Mehammer et al. (2018), Eqs. (11) to (14).

With filters.losses=as_printed, R is multiplied by 1e20 where all six reported positions are exactly
zero, as the author's code does. (There, the factors of a loss also accumulate, up to infinity; that
is left out.) `printed` says what else is corrected.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.estimation.kinematic_predictor import predict_varying
from owtsweep.studies.floater.contract import Estimates, Measured, Scheme, Setting
from owtsweep.studies.floater.schemes.linear import read_inputs
from owtsweep.studies.floater.schemes.printed import (
    begin,
    output_noise,
    predict_ahead,
    process_noise,
)

#: By what R is multiplied in a loss.
LOSS = 1e20


@dataclass(frozen=True)
class VaryingPredictor:
    """The predictor made ready for a setting."""

    setting: Setting

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record."""
        setting = self.setting
        position, acceleration, rate = read_inputs(setting, measured)
        factor = np.where(np.all(position == 0.0, axis=0), LOSS, 1.0)
        estimate, nis = np.empty((*position.shape, 2)), np.empty(position.shape)
        covariance = np.empty((*position.shape, 2, 2))
        start, before = begin(setting, position)
        for i, Q in enumerate(process_noise(setting)):
            R = output_noise(setting, i)
            predict_varying(
                position[i], acceleration[i], rate[i], measured.step, Q, np.resize(R, 2), factor,
                start[i], before[i], (estimate[i], covariance[i], nis[i]),
            )  # fmt: skip
        predict_ahead(setting, estimate, acceleration)
        return Estimates(
            np.ascontiguousarray(estimate[:, :, 0].T),
            np.ascontiguousarray(estimate[:, :, 1].T),
            covariance.transpose(1, 0, 2, 3),
            nis.T,
        )


class Kf(Scheme):
    """The time-varying predictor as printed."""

    name = "KF"

    def prepare(self, setting: Setting) -> VaryingPredictor:
        """Make the predictor ready for a setting."""
        return VaryingPredictor(setting)


SCHEME = Kf()
