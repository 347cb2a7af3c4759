"""MEKF: the multiplicative Kalman filter, alone or with further antennas and states; smoothers.

SMOOTHER passes back over the whole record, as post-processing does, FIXED_LAG over the last
`filters.lag` seconds.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.linalg import expm

from owtsweep.arrays import Array
from owtsweep.estimation.inertial.multiplicative import filter_fixes
from owtsweep.estimation.inertial.smoother import link, smooth_lag
from owtsweep.estimation.inertial.strapdown import ERRORS
from owtsweep.studies.blade.contract import Direct, Estimates, Measured, Setting
from owtsweep.studies.blade.schemes.navigation import (
    Found,
    begin,
    make_record,
    make_room,
    report,
    require_antennas,
)


@dataclass(frozen=True)
class Navigator:
    """The filter, made ready for a setting, with fixes of some antennas and further states.

    Further states are the clock's `offset`, the error of the first antenna's place (`lever`), and
    the hook's `swing`.
    """

    setting: Setting
    antennas: int = 1
    offset: bool = False
    lever: bool = False
    swing: bool = False

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record."""
        return report(self.setting, measured, self.filter(measured), antennas=self.antennas)

    def filter(self, measured: Measured) -> Found:
        """Return states and covariances of all samples."""
        setting, geometry = self.setting, self.setting.geometry
        further = [setting.offset_sigma] * self.offset + [setting.lever_sigma] * 3 * self.lever
        at = ERRORS + len(further)
        transition, shaking, sizes = describe_swing(setting)
        s, P = begin(setting, [*further, *(sizes if self.swing else [])])
        if self.swing:
            s[at + 7 :] = setting.start[0][0] - setting.start[1] @ geometry.unit  # under the hook
        offset = ERRORS if self.offset else -1
        astray = ERRORS + self.offset if self.lever else -1
        begun, agreement = at if self.swing else -1, setting.tuning.agreement**2
        swinging = (begun, -geometry.unit, transition, shaking, agreement)
        found = make_room(measured, len(P))
        record = make_record(setting, measured, self.antennas)
        filter_fixes(record, (s, P), offset, astray, swinging, tuple(found))
        return found


def describe_swing(setting: Setting) -> tuple[Array, Array, list[float]]:
    """Return transitions (3, 2, 2) and noise (3, 3, 3) of a sample, and first deviations (9,).

    The hook's swing is oscillators driven by white noise about a slow middle, which has no
    velocity: the hook is at rest, or wanders by no more than gusts do. Each direction is m'' = -w^2
    m - 2 z w m' + noise, whose stationary variances are the square of the swing's size and w^2
    times it. The middle wanders as gusts do at first, and begins anywhere within some sizes of
    where the point under the hook is given to be.
    """
    transitions, noises, sizes = np.zeros((3, 2, 2)), np.zeros((3, 3, 3)), np.zeros((3, 3))
    for i, mode in enumerate(setting.swing):
        w = 2.0 * np.pi / mode.period
        rate = np.array([[0.0, 1.0], [-(w**2), -2.0 * mode.damping * w]])
        stationary = mode.sigma**2 * np.diag([1.0, w**2])
        transitions[i] = F = expm(rate * setting.step)
        noises[i, :2, :2] = stationary - F @ stationary @ F.T
        noises[i, 2, 2] = 2.0 * mode.gust**2 * setting.step / setting.gust_time
        sizes[:, i] = mode.sigma * np.array([1.0, w, 3.0])
    return transitions, noises, sizes.ravel().tolist()


@dataclass(frozen=True)
class Smoother:
    """The smoother, made ready for a setting: of the whole record, or with a fixed lag."""

    setting: Setting
    whole: bool

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record."""
        setting = self.setting
        states, covariances, nis = Navigator(setting).filter(measured)
        links = (np.empty_like(states), np.empty_like(covariances), np.empty_like(covariances))
        link(states, covariances, make_record(setting, measured), links)
        latency = lag = len(nis)
        if not self.whole:
            lag = round(setting.tuning.lag / measured.step)
            latency = lag + np.diff(np.flatnonzero(measured.due)).max(initial=1) - 1
        out = (np.empty_like(states), np.empty_like(covariances))
        smooth_lag(states, covariances, links, measured.due, lag, out)
        return report(setting, measured, Found(*out, nis), latency=latency * measured.step)


def prepare_heading(setting: Setting) -> Navigator:
    """Make the filter of two antennas ready for a setting; `Unable` if it has one alone."""
    require_antennas(setting, 2)
    return Navigator(setting, antennas=2)


SCHEME = Direct("MEKF", Navigator)
#: A second antenna 20 m along the blade shows the heading.
MEKF_HEADING = Direct("MEKF_HEADING", prepare_heading)
MEKF_OFFSET = Direct("MEKF_OFFSET", partial(Navigator, offset=True))
MEKF_LEVER = Direct("MEKF_LEVER", partial(Navigator, lever=True))
#: While the hook moves, e.g. hoists, it is wrong without knowing it (docs/blade.md).
PENDULUM = Direct("PENDULUM", partial(Navigator, swing=True))
SMOOTHER = Direct("SMOOTHER", partial(Smoother, whole=True))
FIXED_LAG = Direct("FIXED_LAG", partial(Smoother, whole=False))
