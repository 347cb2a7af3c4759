"""HOLD: the last fix stands until the next one; the attitude is that of the start."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.blade.contract import Direct, Estimates, Measured, Setting


@dataclass(frozen=True)
class Hold:
    """Holding, made ready for a setting."""

    setting: Setting

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record."""
        (position, _), rotation = self.setting.start
        geometry = self.setting.geometry
        given = position + rotation @ geometry.levers[0]
        fix = hold_last(measured.fixes[:, 0], given)
        return Estimates(
            root=fix + rotation @ (geometry.root - geometry.antennas[0]),
            root_velocity=np.zeros_like(fix),
            rotation=np.broadcast_to(rotation, (len(fix), 3, 3)),
        )


def hold_last(values: Array, given: Array) -> Array:
    """Return values (steps, ...) in which NaN are those before; `given` before the first one."""
    lost = np.isnan(values).reshape(len(values), -1).any(axis=1)
    last = np.maximum.accumulate(np.where(lost, -1, np.arange(len(values))))
    held = values[np.maximum(last, 0)].copy()
    held[last < 0] = given
    return held


SCHEME = Direct("HOLD", Hold)
