"""The estimates of an estimator over a whole record, or over successive steps of a record."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array


class Trajectory(NamedTuple):
    """The output of an estimator over successive steps of a record.

    Covariances and innovations are NaN at steps without one, and None if no step has one.

    state: Estimates of x, y (m), v_x, v_y (m/s), where x is north and y is east, shape (steps, 4).
    covariance: Covariances of the errors of `state`, shape (steps, 4, 4).
    innovation, innovation_covariance: Shapes (steps, m) and (steps, m, m).
    """

    state: Array
    covariance: Array | None = None
    innovation: Array | None = None
    innovation_covariance: Array | None = None

    @property
    def deviation(self) -> Array:
        """The standard deviations of the errors of `state`, shape (steps, 4); NaN without one."""
        if self.covariance is None:
            return np.broadcast_to(np.nan, self.state.shape)
        return np.asarray(np.sqrt(np.einsum("kii->ki", self.covariance)))

    def axis_covariance(self, axis: int) -> Array:
        """Return covariances of position and velocity along axis 0 or 1, shape (steps, 2, 2)."""
        if self.covariance is None:
            return np.broadcast_to(np.nan, (len(self.state), 2, 2))
        return self.covariance[:, axis::2, axis::2]


def spread_to_both_axes(covariance: Array) -> Array:
    """Make covariances (steps, 4, 4) of x, y, v_x, v_y from those of one axis, (steps, 2, 2).

    Those along y are taken to be equal, and the two axes uncorrelated.
    """
    both = np.zeros((len(covariance), 4, 4))
    both[:, ::2, ::2] = both[:, 1::2, 1::2] = covariance
    return both
