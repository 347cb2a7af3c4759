"""Schemes that do without the inertial unit: HOLD, GNSS_WAHBA and TOTAL_STATIONS.

- HOLD: the last fix stands until the next one; the attitude is that of the start.
- GNSS_WAHBA: position and attitude from three antennas, by Wahba's problem; held between fixes.
- TOTAL_STATIONS: the paper's reference: three prisms, interpolated, by Wahba's problem. Positions
  are interpolated to a common time base, after which Eqs. 4 to 8 give position and attitude
  (section 3.1). The time stamps are taken as they are.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from owtsweep.estimation.wahba import carry_point, find_pose
from owtsweep.sensing.faults import hold_last
from owtsweep.studies.base.schemes import ByFunction, Unable
from owtsweep.studies.blade.contract import PRISMS, ROOT, Direct, Estimates, Measured, Setting
from owtsweep.studies.blade.schemes.navigation import require_antennas


def hold(setting: Setting, measured: Measured) -> Estimates:
    """Hold the last fix."""
    (position, _), rotation = setting.start
    geometry = setting.geometry
    given = position + rotation @ geometry.levers[0]
    fix = hold_last(measured.fixes[:, 0], given)
    return Estimates(
        root=fix + rotation @ (geometry.root - geometry.antennas[0]),
        root_velocity=np.zeros_like(fix),
        rotation=np.broadcast_to(rotation, (len(fix), 3, 3)),
    )


def solve_antennas(setting: Setting, measured: Measured) -> Estimates:
    """Solve Wahba's problem of the antennas; between fixes the last pose stands."""
    (position, _), given = setting.start
    geometry = setting.geometry
    origin, rotation = find_pose(geometry.antennas, measured.fixes)
    rotation = hold_last(rotation, given)
    root = hold_last(
        carry_point(origin, rotation, geometry.root), position + given @ geometry.to_root
    )
    return Estimates(root=root, root_velocity=np.zeros_like(root), rotation=rotation)


def prepare_antennas(setting: Setting) -> ByFunction[Setting, Measured, Estimates]:
    """Make the least squares ready for a setting; `Unable` without three antennas."""
    require_antennas(setting, 3)
    return ByFunction(solve_antennas, setting)


def solve_prisms(setting: Setting, measured: Measured) -> Estimates:
    """Solve Wahba's problem of the prisms; `Unable` without total stations."""
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
        latency=float(np.diff(measured.prism_times).max()),
    )


HOLD = Direct("HOLD", partial(ByFunction, hold))
GNSS_WAHBA = Direct("GNSS_WAHBA", prepare_antennas)
TOTAL_STATIONS = Direct("TOTAL_STATIONS", partial(ByFunction, solve_prisms))
