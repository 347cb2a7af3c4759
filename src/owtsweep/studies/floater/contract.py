"""What passes between the parts of the floater study: truth, measurements, settings, estimates.

All arrays of a record begin with its samples. Columns are the degrees of freedom in the order of
`DOF`: metres for the first three, radians for the last three.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.studies.base import schemes
from owtsweep.studies.base.schemes import Knowledge
from owtsweep.studies.floater.tuning import Tuning

__all__ = ["DOF", "Estimates", "Measured", "Scheme", "Setting"]

#: Degrees of freedom: surge, sway, heave, then the Euler angles roll, pitch, yaw
#: (Mehammer et al. 2018, Eq. 1).
DOF = ("x", "y", "z", "phi", "theta", "psi")


@dataclass(frozen=True)
class Truth:
    """The motion of a record.

    step: Sampling interval in s.
    position, velocity, acceleration: Translations and Euler angles in the basin's frame (NED), and
        their first and second derivatives with time, shape (steps, 6).
    rate: Angular velocity in the body's frame in rad/s, shape (steps, 3) (Eq. 2).
    specific_force: What an ideal accelerometer in the body's frame reads: the acceleration without
        that of gravity, in m/s^2, shape (steps, 3).
    """

    step: float
    position: Array
    velocity: Array
    acceleration: Array
    rate: Array
    specific_force: Array


@dataclass(frozen=True)
class Measured:
    """What the sensors of a record say.

    step: Sampling interval in s.
    position: What the optical system reports at a sample, shape (steps, 6). A sample without a
        report is NaN in all columns, or zero where losses are reported as zeros.
    age: the time in s between the motion that a report shows and the sample at which it arrives,
        shape (steps,); 0 without delay, irregular where the optical system is. A scheme that knows
        no delay ignores it.
    lost: whether the report of a sample was lost, shape (steps,), for schemes that know of losses.
    acceleration: Accelerations of all degrees of freedom in the basin's frame, shape (steps, 6), as
        the paper's simulator gives them (`sensors.frame: global`); None with body-fixed sensors.
    rate: Angular velocities in rad/s, shape (steps, 3): of the Euler angles with `frame: global`,
        in the body's frame with `frame: body`.
    specific_force: Accelerometers fixed to the body in m/s^2, shape (steps, 3); None with `frame:
        global`.
    """

    step: float
    position: Array
    age: Array
    lost: NDArray[np.bool_]
    acceleration: Array | None
    rate: Array
    specific_force: Array | None


@dataclass(frozen=True, eq=False)
class Setting(Knowledge):
    """All that a scheme may know beforehand of a case.

    step: Sampling interval in s.
    position_sigma, rate_sigma, acceleration_sigma: Assumed standard deviations of the noise per
        sample: of reported positions (6,), of rates (3,), and of accelerations (6,). With
        body-fixed sensors the last three accelerations are not measured; their entries are the
        standard deviation of the angular acceleration itself.
    bias_sigma, bias_walk: Assumed standard deviation of the bias of each acceleration, and change
        of that bias per root of a second, shape (6,); 0 where no acceleration is measured.
    delay: Assumed age of a report in s.
    motion_sigma: Standard deviations of position, velocity and acceleration, shape (3, 6): what a
        user knows of the sea state.
    frequency: Natural frequencies in rad/s, shape (6,).
    body: whether sensors are fixed to the body (`sensors.frame: body`).
    zeros: whether a lost report arrives as zeros.
    tuning: the numbers of all schemes.
    start: True position and velocity at sample 0, shape (2, 6); None if schemes do not know it.
    """

    step: float
    position_sigma: Array
    rate_sigma: Array
    acceleration_sigma: Array
    bias_sigma: Array
    bias_walk: Array
    delay: float
    motion_sigma: Array
    frequency: Array
    body: bool
    zeros: bool
    tuning: Tuning
    start: Array | None = None


@dataclass(frozen=True)
class Estimates:
    """What a scheme says about a record.

    position, velocity: Estimates of the position and its time derivative, shape (steps, 6); row k
        is about sample k, whenever it was known.
    covariance: Of position and velocity, per degree of freedom, shape (steps, 6, 2, 2), or (1, 6,
        2, 2) if it does not change; None if the scheme has none.
    nis: Squared innovations of the reported positions over their variance, one per degree of
        freedom, shape (steps, 6), NaN where no report was used; None if the scheme has none.
    latency: Latency in s: 0 but for a smoother of fixed lag.
    """

    position: Array
    velocity: Array
    covariance: Array | None = None
    nis: Array | None = None
    latency: float = 0.0


class Scheme(schemes.Scheme[Setting, Measured, Estimates]):
    """A scheme of the floater study."""

    study = "floater"


class Direct(schemes.Direct[Setting, Measured, Estimates], Scheme):
    """A scheme by its name, and by what makes it ready for a setting."""
