"""What a scheme is: the interface between the study and every estimator, ours or a user's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Estimate as Estimate
from owtsweep.evaluation.estimate import Innovation as Innovation


@dataclass(frozen=True)
class Sensors:
    """What an estimator may know about its sensors (PAPER.md, section 1).

    Attributes
    ----------
    step
        IMU sampling interval T_a, s.
    fix_interval
        M: IMU steps between fixes, which arrive at steps 0, M, 2 M, ...
    delay
        N_d: IMU steps by which a fix is late.
    position_sigma, force_sigma
        Standard deviations per fix (m) and per sample (m/s^2), each axis.
    bias_walk
        Intensity of the bias' Wiener process, m/s^2/sqrt(s).
    yaw
        Fixed yaw psi of the IMU, rad.
    gravity
        Horizontal gravity in NED, m/s^2.
    """

    step: float
    fix_interval: int
    delay: int
    position_sigma: float
    force_sigma: float
    bias_walk: float
    yaw: float
    gravity: tuple[float, float]

    @property
    def rotation(self) -> Array:
        """R of Eq. (5), from the IMU's frame to NED, (2, 2)."""
        cos, sin = np.cos(self.yaw), np.sin(self.yaw)
        return np.array([[cos, -sin], [sin, cos]])

    @property
    def fix_step(self) -> float:
        """T_g, s."""
        return self.fix_interval * self.step


@runtime_checkable
class Estimator(Protocol):
    """A running estimator: one call per IMU step."""

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        """Take one sample and, when there is one, a fix; return the estimate of now.

        Parameters
        ----------
        specific_force
            (2,) in the IMU's frame, m/s^2.
        position
            (2,) in NED, m: the position of `delay` steps ago; None between fixes.
        """
        ...


@runtime_checkable
class Scheme(Protocol):
    """An estimation scheme.

    It may also offer `kernel(sensors, tuning, steps)` for the batch engine: the scheme as an
    `owtsweep.studies.hub.chain.Chain` for records of that many steps.

    Attributes
    ----------
    name
        Unique within a run; how tables and figures call it.
    linear
        Whether estimates are linear in the measurements with gains that do not depend on them;
        then one motion-only and one noise-only run serve every amplitude.
    """

    name: str
    linear: bool

    def start(self, sensors: Sensors, tuning: Any) -> Estimator:
        """A fresh estimator at the zero estimate. `tuning` holds ekf, mkf, hme1, hme2 and hme."""
        ...
