"""The interface between the hub study and any scheme, built in or a user's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Estimate


@dataclass(frozen=True)
class Sensors:
    """What an estimator may know about its sensors (PAPER.md, section 1).

    Attributes
    ----------
    step
        IMU sampling interval T_a, s.
    fix_interval
        M, IMU steps between fixes. These arrive at steps 0, M, 2 M, ...
    delay
        N_d, IMU steps from the instant that a fix reports to its arrival.
    position_sigma, force_sigma
        Standard deviations per axis: of a fix (m) and of an IMU sample (m/s^2).
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
        """R of Eq. (5), (2, 2): turns vectors from the IMU's frame to NED."""
        cos, sin = np.cos(self.yaw), np.sin(self.yaw)
        return np.array([[cos, -sin], [sin, cos]])

    @property
    def fix_step(self) -> float:
        """T_g, the time between fixes, s."""
        return self.fix_interval * self.step


@runtime_checkable
class Estimator(Protocol):
    """A running estimator. It is called once per IMU step."""

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        """Take one IMU sample, and a fix if there is one; return the estimate of the present.

        Parameters
        ----------
        specific_force
            (2,) in the IMU's frame, m/s^2.
        position
            (2,) in NED, m: the position of `delay` steps ago. None between fixes.

        Returns
        -------
        Estimate
            Position and velocity, (2,) each in NED, in m and m/s. Its covariance, if it has one,
            is (4, 4) of (x, y, v_x, v_y); its innovation is that of the fix, (2,) in m.
        """
        ...


@runtime_checkable
class Scheme(Protocol):
    """An estimation scheme.

    It may also offer `kernel(sensors, tuning, steps)` for the batch engine. That gives the scheme
    as an `owtsweep.studies.hub.chain.Chain` for records of `steps` steps.

    Attributes
    ----------
    name
        Its name in tables and figures; unique within a run.
    linear
        Whether estimates are linear in the measurements and gains do not depend on these. Then one
        run with the motion alone and one with the noise alone serve every amplitude.
    """

    name: str
    linear: bool

    def start(self, sensors: Sensors, tuning: Any) -> Estimator:
        """Return a fresh estimator whose estimate is zero.

        Parameters
        ----------
        tuning
            The study's configuration; its sections ekf, mkf, hme1, hme2 and hme hold the tuning.
        """
        ...
