"""GNSS_WAHBA: position and attitude from three antennas, by Wahba's problem; held between fixes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.estimation.wahba import carry_point, find_pose
from owtsweep.studies.blade.contract import Estimates, Measured, Scheme, Setting
from owtsweep.studies.blade.schemes.hold import hold_last
from owtsweep.studies.blade.schemes.navigation import require_antennas


@dataclass(frozen=True)
class Geometry:
    """The least squares, made ready for a setting."""

    setting: Setting

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record."""
        (position, _), given = self.setting.start
        geometry = self.setting.geometry
        origin, rotation = find_pose(geometry.antennas, measured.fixes)
        rotation = hold_last(rotation, given)
        root = hold_last(
            carry_point(origin, rotation, geometry.root), position + given @ geometry.to_root
        )
        return Estimates(root=root, root_velocity=np.zeros_like(root), rotation=rotation)


class GeometryScheme(Scheme):
    """Three antennas and Wahba's problem."""

    name = "GNSS_WAHBA"

    def prepare(self, setting: Setting) -> Geometry:
        """Make the least squares ready for a setting; `Unable` without three antennas."""
        require_antennas(setting, 3)
        return Geometry(setting)


SCHEME = GeometryScheme()
