"""Heading, pitch and roll of a blade by Maes et al. (2018), Eqs. 9 to 11, as they are printed."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.blade_angles import require_rotations


def find_angles_as_printed(rotations: Array) -> Array:
    """Return heading, pitch and roll, rad, shape (samples, 3), of rotation matrices.

    Quotients are clipped to [-1, 1], which rounding may exceed. Angles below 1e-8 rad become 0.

    Parameters
    ----------
    rotations
        Shape (samples, 3, 3).

    Raises
    ------
    InputError
        If a matrix is no rotation.
    """
    require_rotations(rotations)
    T = np.moveaxis(rotations, 0, -1)
    in_plane = np.sqrt(T[0, 0] ** 2 + T[1, 0] ** 2)
    psi = -sign(T[1, 0]) * arccos(T[0, 0], in_plane)
    theta = -sign(T[2, 0]) * arccos(in_plane, np.sqrt(in_plane**2 + T[2, 0] ** 2))
    numerator = T[0, 1] * np.sin(psi) + T[1, 1] * np.cos(psi)
    whole = np.sqrt(T[0, 1] ** 2 + T[1, 1] ** 2 + T[2, 1] ** 2)
    return np.column_stack([psi, theta, sign(T[2, 1]) * arccos(numerator, whole)])


def sign(values: Array) -> Array:
    """Return 1 where values are 0 or more and -1 elsewhere, as below Eq. 11."""
    return np.where(values >= 0.0, 1.0, -1.0)


def arccos(leg: Array, hypotenuse: Array) -> Array:
    """Return the arccos, rad, of a quotient that rounding may have pushed beyond 1."""
    return np.asarray(np.arccos(np.clip(leg / hypotenuse, -1.0, 1.0)))
