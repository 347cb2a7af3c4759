"""Pose of a rigid body from three or more of its points: Wahba's problem, solved by an SVD.

The points' coordinates are known in a reference frame fixed to the body and observed in a frame at
rest. The position p of the reference frame's origin and the rotation T minimise

    sum_k |observed_k - p - T reference_k|^2

(Maes et al. 2018, section 3.1, Eqs. 4-8, after Wahba 1965 and Markley 1988). The paper takes
differences to its first prism, so the noise of that prism enters all of them. Differences to the
centroid solve the problem above exactly and have less noise.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError

#: What differences are taken to: the centroid, or the first point as in Eqs. 4-7.
About = Literal["centroid", "first"]

#: Least part of the second singular value in the first, below which a sample fixes no rotation.
LEAST = 1e-9


def find_pose(
    reference: Array, observed: Array, *, about: About = "centroid"
) -> tuple[Array, Array]:
    """Return the positions and rotations that carry reference points to observed ones.

    Positions of the reference frame's origin are in m, shape (samples, 3). Rotation matrices turn
    vectors of the reference frame into the frame at rest, with determinant +1, shape
    (samples, 3, 3).

    reference: coordinates of the points in the reference frame, m, shape (points, 3), at least 3
        points.
    observed: their observed coordinates, m, shape (samples, points, 3). A sample in which any of
        them is not finite gets a pose of NaN.
    about: what differences are taken to: "centroid", or "first" as in the paper.
    Raises InputError if the points of a sample are collinear, so that any turn about their line
    explains them as well.
    """
    first = np.arange(len(reference)) == 0
    anchor = first.astype(float) if about == "first" else np.full(len(first), 1.0 / len(first))
    seen = np.isfinite(observed).all(axis=(1, 2))
    points = observed[seen]
    to_anchor = anchor @ points
    there = points - to_anchor[:, None]
    here = reference - anchor @ reference

    # Eq. 6: columns of `there` times rows of `here`, summed over the points.
    left, sizes, right = np.linalg.svd(np.swapaxes(there, 1, 2) @ here)
    hand = np.sign(np.linalg.det(left) * np.linalg.det(right))
    # Markley 1988: the best rotation is unique if s2 + det(U) det(V) s3 > 0.
    lost = sizes[:, 1] + hand * sizes[:, 2] <= LEAST * sizes[:, 0]
    if lost.any():
        sample = int(np.flatnonzero(seen)[np.argmax(lost)])
        raise InputError(
            f"observed: the points of sample {sample} are collinear or a mirror image, which "
            "leaves the rotation undetermined; NaN in place of bad points would work"
        )
    # Eqs. 5 and 7: M = diag(1, 1, det(U) det(V)), put into the last column of U.
    left[:, :, 2] *= hand[:, None]
    turned = left @ right

    positions = np.full((len(observed), 3), np.nan)
    rotations = np.full((len(observed), 3, 3), np.nan)
    rotations[seen] = turned
    positions[seen] = to_anchor - turned @ (anchor @ reference)
    return positions, rotations


def carry_point(position: Array, rotation: Array, point: Array) -> Array:
    """Return where a point (3,) of the body is, m, shape (samples, 3): Eqs. 2 and 8.

    The paper calls the left-hand sides translations (u, v, w). As printed, both equations return
    positions: they add a turned difference of coordinates to what is measured of one point. That is
    a translation only after the point's reference coordinates are subtracted.

    position, rotation: poses as `find_pose` returns them.
    point: in the reference frame, m.
    """
    return np.asarray(position + rotation @ point)
