"""What passes between the parts of the blade study: truth, measurements, settings, estimates.

The frame is that of Maes et al. (2018), Fig. 2: x along the blade from root to tip, z up, origin at
the blade's centre of gravity in its reference position. The body's frame is this one at rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.studies.base import schemes
from owtsweep.studies.base.schemes import Knowledge
from owtsweep.studies.blade.sections import DOF, Freedom
from owtsweep.studies.blade.tuning import Tuning

__all__ = ["DOF", "Estimates", "Measured", "Scheme", "Setting"]

#: The blade's root in the body's frame, m (section 3.1).
ROOT = np.array([-17.93, 0.0, 0.0])
#: The inertial unit, m. The paper shows it in a picture only: on top of the blade near the root.
UNIT = np.array([-16.0, 0.0, 1.6])
#: Antennas, m: on the unit's box, and two more for schemes that use them, on the prisms 2 and 3.
ANTENNAS = np.array([[-16.0, 0.0, 2.0], [4.0, -2.0, 1.0], [12.0, 2.2, 0.5]])
#: Prisms of the total stations, m (the paper's are only drawn; these are those of our plan).
PRISMS = np.array([[-14.0, 1.8, 1.2], [4.0, -2.0, 1.0], [12.0, 2.2, 0.5]])


class Geometry(NamedTuple):
    """Where points are in the body's frame, m; its origin is the point under the hook.

    The blade's root and the inertial unit have the shape (3,), the antennas that the record has (k,
    3).
    """

    root: Array
    unit: Array
    antennas: Array

    @property
    def levers(self) -> Array:
        """Where antennas are from the unit, shape (k, 3)."""
        return self.antennas - self.unit

    @property
    def to_root(self) -> Array:
        """Where the root is from the unit, shape (3,)."""
        return self.root - self.unit


#: The geometry of simulated records.
PLAN = Geometry(ROOT, UNIT, ANTENNAS)


class Start(NamedTuple):
    """How a record begins, as it is given to schemes, and where sensors are on its blade.

    pose: Position and velocity of the unit, shape (2, 3), m and m/s, and its attitude, (3, 3).
    sigma: Standard deviations of position (m), velocity (m/s), tilt and heading (rad).
    """

    pose: tuple[Array, Array]
    sigma: Array
    geometry: Geometry = PLAN


class BoomMotion(NamedTuple):
    """Displacement (m) and acceleration (m/s^2) of the boom's tip, (n, 3), at a rate in Hz."""

    rate: float
    position: Array
    acceleration: Array


class Accelerations(NamedTuple):
    """What the accelerometers on the boom's tip say, m/s^2, shape (n, 3), at a rate in Hz."""

    rate: float
    values: Array


@dataclass(frozen=True)
class Truth:
    """The motion of a record.

    step: Sampling interval in s.
    rotation: Turns vectors of the body into the frame at rest, shape (steps, 3, 3).
    root, root_velocity, unit, unit_velocity: Of the blade's root and of the inertial unit, m and
        m/s, shape (steps, 3).
    rate: Angular velocity in the body's frame, rad/s, shape (steps, 3).
    specific_force: What an ideal accelerometer at the unit reads, m/s^2, shape (steps, 3).
    boom: How the tip of the crane's boom moves; None if nobody knows.
    """

    step: float
    rotation: Array
    root: Array
    root_velocity: Array
    unit: Array
    unit_velocity: Array
    rate: Array
    specific_force: Array
    boom: BoomMotion | None = None


@dataclass(frozen=True)
class Measured:
    """What the sensors of a record say.

    step: Sampling interval in s.
    specific_force, rate: Of the inertial unit in the body's frame, m/s^2 and rad/s, shape (steps,
        3).
    fixes: RTK-GNSS positions of `ANTENNAS`, m, shape (steps, 3, 3), at the sample of their time
        stamp; NaN where none is. Most schemes look at the first antenna alone.
    due: whether a fix is due at a sample, lost or not, shape (steps,).
    floating: whether the receiver's solution is float, not fixed, shape (steps,): it says so
        itself.
    prism_times, prisms: Time stamps in s and positions in m of the prisms by the total stations,
        shapes (n,) and (n, 3, 3).
    boom: Accelerations of the boom's tip; None if nothing is there.
    """

    step: float
    specific_force: Array
    rate: Array
    fixes: Array
    due: NDArray[np.bool_]
    floating: NDArray[np.bool_]
    prism_times: Array
    prisms: Array
    boom: Accelerations | None = None


@dataclass(frozen=True, eq=False)
class Setting(Knowledge):
    """All that a scheme may know beforehand of a case; standard deviations are priors.

    step: Sampling interval in s.
    fix_sigma, float_sigma: Standard deviations of a fix, m, shape (3,): of a fixed, and of a float
        solution.
    force_sigma, rate_sigma: Noise of a sample of accelerometers (m/s^2) and gyroscopes (rad/s).
    force_bias, rate_bias, force_walk, rate_walk: Standard deviations of their biases, and change of
        the biases per root of a second.
    start, start_sigma: Position and velocity of the unit, shape (2, 3), and its attitude (3, 3), as
        they are given at the first sample: nobody can observe a hanging blade's heading in a record
        (F10). And their standard deviations: m, m/s, tilt and heading in rad.
    offset_sigma: Standard deviation of the clock's offset, s; 0 if it is taken for nothing.
    lever_sigma: Standard deviation, along each axis of the body, of the error of the antenna's
        place, m.
    swing, gust_time: How the point under the hook moves along x, y and z: resonances, and slow
        wandering in gusts, in m; and the time constant of gusts (s).
    tuning: the numbers of all schemes.
    geometry: where root, inertial unit and antennas are.
    """

    step: float
    fix_sigma: Array
    float_sigma: Array
    force_sigma: float
    rate_sigma: float
    force_bias: float
    rate_bias: float
    force_walk: float
    rate_walk: float
    start: tuple[Array, Array]
    start_sigma: Array
    offset_sigma: float
    lever_sigma: float
    swing: tuple[Freedom, ...]
    gust_time: float
    tuning: Tuning
    geometry: Geometry = PLAN


@dataclass(frozen=True)
class Estimates:
    """What a scheme says about a record.

    root, root_velocity: Of the blade's root, m and m/s, shape (steps, 3).
    rotation: Attitude, shape (steps, 3, 3).
    root_covariance, attitude_covariance: Of the root's position (m^2) and of the attitude's error
        in the body's frame (rad^2), shape (steps, 3, 3); None if the scheme has none.
    nis: Squared innovation of a fix over its covariance and dimension, shape (steps,), NaN without
        a fix; None if the scheme has none.
    latency: Latency in s; the record's length if all of it is needed.
    boom: Displacement of the boom's tip above .15 Hz at 20 Hz, m, shape (n, 3); None if the scheme
        does not look at the boom.
    """

    root: Array
    root_velocity: Array
    rotation: Array
    root_covariance: Array | None = None
    attitude_covariance: Array | None = None
    nis: Array | None = None
    latency: float = 0.0
    boom: Array | None = None


class Scheme(schemes.Scheme[Setting, Measured, Estimates]):
    """A scheme of the blade study."""

    study = "blade"


class Direct(schemes.Direct[Setting, Measured, Estimates], Scheme):
    """A scheme by its name, and by what makes it ready for a setting."""
