"""MEKF: the multiplicative Kalman filter, alone, with a second antenna, an offset or a swing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.inertial import ERRORS
from owtsweep.estimation.inertial_filter import SWING, filter_fixes
from owtsweep.studies.blade.contract import UNIT, Estimates, Measured, Setting
from owtsweep.studies.blade.schemes.navigation import (
    LEVERS,
    Found,
    begin,
    find_noise,
    make_room,
    report,
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
    swing
        Whether the hook's swing is known.
    """

    setting: Setting
    antennas: int = 1
    offset: bool = False
    swing: bool = False

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record."""
        return report(measured, self.filter(measured), antennas=self.antennas)

    def filter(self, measured: Measured) -> Found:
        """Return states and covariances of all samples."""
        setting = self.setting
        more = self.offset + SWING * self.swing
        s, P = begin(setting, more)
        offset, at = -1, -1
        if self.offset:
            offset = ERRORS
            P[offset, offset] = setting.offset_sigma**2
        transition: Array = np.zeros((3, 2, 2))
        shaking: Array = np.zeros((3, 3, 3))
        if self.swing:
            at = ERRORS + self.offset
            transition, shaking = describe_swing(setting, s, P, at)
        found = make_room(measured, more)
        fixes = np.ascontiguousarray(measured.fixes[:, : self.antennas])
        filter_fixes(
            fixes, LEVERS[: self.antennas], setting.fix_sigma**2, measured.due,
            measured.specific_force, measured.rate, measured.step, find_noise(setting), (s, P),
            offset, (at, -UNIT, transition, shaking, setting.tuning.agreement**2), tuple(found),
        )  # fmt: skip
        return found


class NavigatorScheme:
    """The multiplicative filter with what it is given besides."""

    def __init__(
        self, name: str, *, antennas: int = 1, offset: bool = False, swing: bool = False
    ) -> None:
        self.name = name
        self.antennas, self.offset, self.swing = antennas, offset, swing

    def prepare(self, setting: Setting) -> Navigator:
        """Make the filter ready for a setting."""
        return Navigator(setting, self.antennas, self.offset, self.swing)


SCHEME = NavigatorScheme("MEKF")
