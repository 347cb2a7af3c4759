"""GNSS_WAHBA: position and attitude from three antennas, by Wahba's problem; held between fixes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.estimation.wahba import carry_point, find_pose
from owtsweep.studies.blade.contract import ANTENNAS, ROOT, UNIT, Estimates, Measured, Setting
from owtsweep.studies.blade.schemes.hold import hold_last


@dataclass(frozen=True)
class Geometry:
    """The least squares, made ready for a setting."""

    setting: Setting

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record."""
        (position, _), given = self.setting.start
        origin, rotation = find_pose(ANTENNAS, measured.fixes)
        rotation = hold_last(rotation, given)
        root = hold_last(carry_point(origin, rotation, ROOT), position + given @ (ROOT - UNIT))
        return Estimates(root=root, root_velocity=np.zeros_like(root), rotation=rotation)


class GeometryScheme:
    """Three antennas and Wahba's problem."""

    name = "GNSS_WAHBA"

    def prepare(self, setting: Setting) -> Geometry:
        """Make the least squares ready for a setting."""
        return Geometry(setting)


SCHEME = GeometryScheme()
