"""MEKF: the multiplicative Kalman filter, alone or with further antennas and states."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.inertial import ERRORS
from owtsweep.estimation.inertial_filter import SWING, filter_fixes
from owtsweep.studies.blade.contract import Estimates, Measured, Scheme, Setting
from owtsweep.studies.blade.schemes.navigation import (
    Found,
    begin,
    find_noise,
    find_variance,
    make_room,
    report,
    require_antennas,
)
from owtsweep.studies.blade.schemes.swing import describe_swing


@dataclass(frozen=True)
class Navigator:
    """The filter, made ready for a setting.

    Attributes
    ----------
    setting
        The setting.
    antennas
        Of how many antennas fixes are used.
    offset
        Whether the clock's offset is a state.
    lever
        Whether the error of the first antenna's place is a state.
    swing
        Whether the hook's swing is known.
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
        more = self.offset + 3 * self.lever + SWING * self.swing
        s, P = begin(setting, more)
        offset, astray, at = -1, -1, -1
        if self.offset:
            offset = ERRORS
            P[offset, offset] = setting.offset_sigma**2
        if self.lever:
            astray = ERRORS + self.offset
            P[astray : astray + 3, astray : astray + 3] = setting.lever_sigma**2 * np.eye(3)
        transition: Array = np.zeros((3, 2, 2))
        shaking: Array = np.zeros((3, 3, 3))
        if self.swing:
            at = ERRORS + self.offset + 3 * self.lever
            transition, shaking = describe_swing(setting, s, P, at)
        found = make_room(measured, more)
        fixes = np.ascontiguousarray(measured.fixes[:, : self.antennas])
        filter_fixes(
            fixes, geometry.levers[: self.antennas], find_variance(setting, measured), measured.due,
            measured.specific_force, measured.rate, measured.step, find_noise(setting), (s, P),
            offset, astray, (at, -geometry.unit, transition, shaking, setting.tuning.agreement**2),
            tuple(found),
        )  # fmt: skip
        return found


class NavigatorScheme(Scheme):
    """The multiplicative filter with what it is given besides: attributes of `Navigator`."""

    def __init__(self, name: str, **given: Any) -> None:
        self.name, self.given = name, given

    def prepare(self, setting: Setting) -> Navigator:
        """Make the filter ready for a setting; `Unable` if it has too few antennas."""
        require_antennas(setting, self.given.get("antennas", 1))
        return Navigator(setting, **self.given)


SCHEME = NavigatorScheme("MEKF")
