"""What an estimator gives at one step."""

from __future__ import annotations

from typing import NamedTuple

from owtsweep.arrays import Array


class Innovation(NamedTuple):
    """A position innovation, (2,) in m, and its covariance, (2, 2) in m^2."""

    value: Array
    covariance: Array


class Estimate(NamedTuple):
    """The estimate of the present state, in NED.

    Attributes
    ----------
    position, velocity
        (2,) in m and m/s.
    covariance
        (4, 4) of (x, y, v_x, v_y), or None; with it the study reports NEES.
    innovation
        The position innovation of this step, or None; with it the study reports NIS.
    """

    position: Array
    velocity: Array
    covariance: Array | None = None
    innovation: Innovation | None = None
