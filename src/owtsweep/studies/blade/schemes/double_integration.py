"""DOUBLE_INTEGRATION: accelerations integrated twice above .15 Hz, and fixes below it.

The chain of Maes et al. (2018), Fig. 8, for the crane's boom, and the same for the blade, whose
slow motion the fixes of one antenna show. The high-pass filter runs in both directions, so nothing
is delayed, and nothing is known before the record ends. The attitude is that of COMPLEMENTARY.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.estimation.double_integration import PADDING, integrate_twice, pass_high
from owtsweep.gravity import GRAVITY
from owtsweep.studies.base.contract import Unable
from owtsweep.studies.blade.boom import estimate_boom
from owtsweep.studies.blade.contract import Direct, Estimates, Measured, Setting
from owtsweep.studies.blade.schemes.complementary import Complementary


@dataclass(frozen=True)
class Chain:
    """The filters, made ready for a setting."""

    setting: Setting

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record.

        Raises
        ------
        Unable
            If the record is not longer than the filter's padding, or has no fix.
        """
        steps, step = len(measured.rate), measured.step
        geometry = self.setting.geometry
        if steps * step <= PADDING:
            raise Unable(f"the filter needs more than {PADDING:g} s of measurements")
        rotation = Complementary(self.setting).run(measured).rotation
        fixed = np.flatnonzero(np.isfinite(measured.fixes[:, 0]).all(axis=1))
        if len(fixed) == 0:
            raise Unable("there is no fix of the first antenna")
        unit = measured.fixes[fixed, 0] - rotation[fixed] @ geometry.levers[0]
        felt = np.einsum("nij,nj->ni", rotation, measured.specific_force)
        place = merge(felt - [0.0, 0.0, GRAVITY], step, fixed, unit)
        root = place + rotation @ geometry.to_root
        boom = None if measured.boom is None else estimate_boom(measured.boom)
        return Estimates(
            root=root,
            root_velocity=np.gradient(root, step, axis=0),
            rotation=rotation,
            wait=steps * step,
            boom=boom,
        )


def merge(acceleration: Array, step: float, at: NDArray[np.intp], positions: Array) -> Array:
    """Return positions (steps, 3) of accelerations (steps, 3) above .15 Hz and of fixes below it.

    Both parts add up to one: what the filter takes from the fixes is what it leaves of the
    acceleration. Fixes, at the samples `at`, are interpolated, and held before the first and after
    the last one.
    """
    time = np.arange(len(acceleration))
    slow = np.column_stack([np.interp(time, at, column) for column in positions.T])
    moved = integrate_twice(acceleration, 1.0 / step)
    return slow + pass_high(moved - slow, 1.0 / step)


SCHEME = Direct("DOUBLE_INTEGRATION", Chain)
