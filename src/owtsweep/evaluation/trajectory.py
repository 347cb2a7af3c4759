"""The estimates of a whole record, or of a piece of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array


class Trajectory(NamedTuple):
    """The output of an estimator over some steps.

    Attributes
    ----------
    state
        (steps, n): the judged quantities, one after the other; of a planar motion x, y (m), v_x,
        v_y (m/s) in NED.
    covariance
        (steps, n, n) of the state, NaN at steps without one; None if no step has one.
    innovation, innovation_covariance
        (steps, m) and (steps, m, m), NaN at steps without one; None if no step has one.
    """

    state: Array
    covariance: Array | None = None
    innovation: Array | None = None
    innovation_covariance: Array | None = None

    @property
    def deviation(self) -> Array:
        """(steps, n): standard deviations of the state; NaN without a covariance."""
        if self.covariance is None:
            return np.broadcast_to(np.nan, self.state.shape)
        return np.asarray(np.sqrt(np.einsum("kii->ki", self.covariance)))

    @property
    def scaled_innovation(self) -> Array:
        """(steps, m): innovations over their own standard deviations; NaN at steps without one.

        If no step has one, m is 1.
        """
        if self.innovation is None or self.innovation_covariance is None:
            return np.broadcast_to(np.nan, (len(self.state), 1))
        variance = np.einsum("kii->ki", self.innovation_covariance)
        return np.asarray(self.innovation / np.sqrt(variance))

    def axis_covariance(self, axis: int) -> Array:
        """(steps, 2, 2) of (p, v) along x (0) or y (1) of a planar motion; NaN without one."""
        if self.covariance is None:
            return np.broadcast_to(np.nan, (len(self.state), 2, 2))
        return self.covariance[:, axis::2, axis::2]

    def part(self, steps: slice) -> Trajectory:
        """Some of the steps, without a copy."""
        return Trajectory(*(None if a is None else a[steps] for a in self))  # type: ignore[arg-type]

    def copy(self) -> Trajectory:
        """A copy. Unlike a part made by `part`, it does not keep the whole trajectory in memory."""
        return Trajectory(*(None if a is None else np.array(a) for a in self))  # type: ignore[arg-type]


def join(pieces: Sequence[Trajectory]) -> Trajectory:
    """Join successive pieces. Arrays that only some pieces have are NaN in the others."""
    state = np.concatenate([piece.state for piece in pieces])
    return Trajectory(state, *(_join([piece[i] for piece in pieces], pieces) for i in (1, 2, 3)))


def _join(series: Sequence[Array | None], pieces: Sequence[Trajectory]) -> Array | None:
    shape = next((array.shape[1:] for array in series if array is not None), None)
    if shape is None:
        return None
    return np.concatenate([
        np.broadcast_to(np.nan, (len(piece.state), *shape)) if array is None else array
        for array, piece in zip(series, pieces, strict=True)
    ])  # fmt: skip


def spread_to_both_axes(covariance: Array) -> Array:
    """(n, 2, 2) of (p, v), the same for x and y, as (n, 4, 4) of a planar motion."""
    return np.kron(covariance, np.eye(2))
