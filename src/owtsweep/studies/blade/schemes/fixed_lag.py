"""FIXED_LAG: MEKF and a pass back over the last `filters.lag` seconds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.estimation.inertial_smoother import smooth_lag
from owtsweep.studies.blade.contract import Direct, Estimates, Measured, Setting
from owtsweep.studies.blade.schemes.mekf import Navigator
from owtsweep.studies.blade.schemes.navigation import Found, report
from owtsweep.studies.blade.schemes.smoother import link_samples


@dataclass(frozen=True)
class FixedLag:
    """The smoother, made ready for a setting."""

    setting: Setting

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record."""
        states, covariances, nis = Navigator(self.setting).filter(measured)
        links = link_samples(self.setting, measured, states, covariances)
        out = (np.empty_like(states), np.empty_like(covariances))
        lag = round(self.setting.tuning.lag / measured.step)
        smooth_lag(states, covariances, links, measured.due, lag, out)
        between = np.diff(np.flatnonzero(measured.due)).max(initial=1) - 1
        return report(
            self.setting, measured, Found(*out, nis), wait=(lag + between) * measured.step
        )


SCHEME = Direct("FIXED_LAG", FixedLag)
