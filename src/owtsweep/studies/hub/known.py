"""What schemes of the hub study are told, what they get of a record, and what an estimator is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Estimate
from owtsweep.gravity import GRAVITY
from owtsweep.studies.base.knowledge import Knowledge

if TYPE_CHECKING:
    from owtsweep.studies.hub.config import HubConfig

#: Where the coordinates of the studies begin. An origin of None stands for the first fix.
ZERO = (0.0, 0.0)


@dataclass(frozen=True)
class Sensors:
    """The properties of IMU and GNSS that an estimator may know.

    Attributes
    ----------
    step
        Sampling interval T_a of the IMU, s.
    fix_interval
        Number M of IMU steps between position fixes, which arrive at steps 0, M, 2 M, ...
    delay
        Number N_d of IMU steps from the instant whose position a fix reports to the fix's arrival.
    position_sigma, force_sigma
        Standard deviations per axis: of a fix (m) and of an IMU sample (m/s^2).
    bias_walk
        Intensity of the bias' Wiener process, m/s^2/sqrt(s).
    yaw
        Fixed yaw psi of the IMU, rad.
    gravity
        Horizontal part of gravity, north and east, m/s^2.
    tilt
        Lean of the IMU per displacement, rad/m. The paper neglects it (section 3, assumption 2).
    high_pass
        Corner of the IMU's AC coupling, Hz, or None. Estimators of the package do not use it.
    fix_scale
        Position in a fix per true position. Estimators of the package do not use it.
    """

    step: float
    fix_interval: int
    delay: int
    position_sigma: float
    force_sigma: float
    bias_walk: float
    yaw: float
    gravity: tuple[float, float]
    tilt: float = 0.0
    high_pass: float | None = None
    fix_scale: float = 1.0

    @property
    def lean(self) -> float:
        """The specific force by leaning, g tilt, in m/s^2 per metre of displacement.

        The IMU's x axis points outwards; where the tower leans outwards by theta, it points down by
        theta. So gravity, which an IMU feels as an acceleration upwards, gives -g sin theta.
        """
        return GRAVITY * self.tilt

    @property
    def rotation(self) -> Array:
        """The matrix R (2, 2) that turns vectors from the IMU's frame to NED.

        Source: Eq. (5) of Ren et al. (2019).
        """
        cos, sin = np.cos(self.yaw), np.sin(self.yaw)
        return np.array([[cos, -sin], [sin, cos]])

    @property
    def fix_step(self) -> float:
        """The time T_g between position fixes, s."""
        return self.fix_interval * self.step


@dataclass(frozen=True, eq=False)
class Known(Knowledge):
    """All that a scheme may know beforehand of a case.

    Attributes
    ----------
    sensors
        The properties of the sensors.
    tuning
        The configuration of one tuning; its sections ekf, mkf, hme1, hme2, hme, ... hold the
        numbers of the schemes.
    natural_period, amplitude
        Natural period of the turbine, s, and amplitude of the motion, m, for schemes that are told
        the motion (`Scheme.told_motion`); None: nobody tells.
    """

    sensors: Sensors
    tuning: HubConfig
    natural_period: float | None = None
    amplitude: float | None = None


class Measured(NamedTuple):
    """What the sensors of a record say, or the part that motion or noise contributes to it.

    Attributes
    ----------
    specific_force
        Specific force in the IMU's frame, m/s^2, shape (steps, 2).
    fixes
        Positions in NED, m, shape (fixes, 2), at the steps 0, M, 2 M, ...; NaN where one is lost.
    """

    specific_force: Array
    fixes: Array


class Estimator(Protocol):
    """The interface of a running estimator, whose method `update` is called once per IMU step."""

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        """Take an IMU sample, and a position fix or None; return the estimate of the present.

        Parameters
        ----------
        specific_force
            Specific force in the IMU's frame, m/s^2, shape (2,).
        position
            The fix in NED, m, shape (2,): the position of `Sensors.delay` steps ago. None at steps
            without a fix.

        Returns
        -------
        Estimate
            Position (m) and velocity (m/s) in NED, shape (2,) each. The estimate may have a
            covariance (4, 4) of x, y, v_x, v_y, and the innovation of the fix, shape (2,), m.
        """
        ...
