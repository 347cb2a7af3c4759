"""TOTAL_STATIONS: the paper's reference: three prisms, interpolated, by Wahba's problem.

Positions are interpolated to a common time base, after which Eqs. 4 to 8 give position and attitude
(section 3.1). The time stamps are taken as they are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.estimation.wahba import carry_point, find_pose
from owtsweep.studies.base.contract import Unable
from owtsweep.studies.blade.contract import PRISMS, ROOT, Direct, Estimates, Measured, Setting


@dataclass(frozen=True)
class Stations:
    """The least squares, made ready for a setting."""

    setting: Setting

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record."""
        if len(measured.prisms) == 0:
            raise Unable("needs total stations, and the record has none")
        steps, step = len(measured.rate), measured.step
        time = step * np.arange(steps)
        flat = measured.prisms.reshape(len(measured.prisms), -1)
        columns = [np.interp(time, measured.prism_times, column) for column in flat.T]
        points = np.column_stack(columns).reshape(steps, *PRISMS.shape)
        origin, rotation = find_pose(PRISMS, points, about="first")
        root = carry_point(origin, rotation, ROOT)
        return Estimates(
            root=root,
            root_velocity=np.gradient(root, step, axis=0),
            rotation=rotation,
            wait=float(np.diff(measured.prism_times).max()),
        )


SCHEME = Direct("TOTAL_STATIONS", Stations)
