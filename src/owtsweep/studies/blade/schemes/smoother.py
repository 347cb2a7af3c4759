"""MEKF and a pass back: over the whole record (SMOOTHER), or the last `filters.lag` s (FIXED_LAG).

SMOOTHER is what post-processing does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.inertial_smoother import link, smooth_all, smooth_lag
from owtsweep.studies.blade.contract import Direct, Estimates, Measured, Setting
from owtsweep.studies.blade.schemes.mekf import Navigator
from owtsweep.studies.blade.schemes.navigation import Found, find_noise, report


@dataclass(frozen=True)
class Smoother:
    """The smoother, made ready for a setting."""

    setting: Setting

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record."""
        states, covariances, nis = Navigator(self.setting).filter(measured)
        links = link_samples(self.setting, measured, states, covariances)
        out = (np.empty_like(states), np.empty_like(covariances))
        smooth_all(states, covariances, links, out)
        return report(self.setting, measured, Found(*out, nis), wait=len(nis) * measured.step)


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


def link_samples(
    setting: Setting, measured: Measured, states: Array, covariances: Array
) -> tuple[Array, Array, Array]:
    """Return how samples follow from later ones, as of `inertial_smoother.link`."""
    links = (np.empty_like(states), np.empty_like(covariances), np.empty_like(covariances))
    link(
        states, covariances, measured.specific_force, measured.rate, measured.step,
        find_noise(setting), links,
    )  # fmt: skip
    return links


SCHEME = Direct("SMOOTHER", Smoother)
FIXED_LAG = Direct("FIXED_LAG", FixedLag)
