"""Poses from points: exact, and against scipy one by one."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from owtsweep.errors import InputError
from owtsweep.estimation.wahba import carry_point, find_pose

PRISMS = np.array([[-14.0, 1.8, 1.2], [4.0, -2.0, 1.0], [12.0, 2.2, 0.5]])
FIVE = np.concatenate([PRISMS, [[0.0, 1.0, -3.0], [-5.0, -4.0, 2.0]]])
ABOUT = ("centroid", "first")


def move(reference, positions, rotations):
    return np.array(
        [[p + R @ r for r in reference] for p, R in zip(positions, rotations, strict=True)]
    )


def draw_poses(rng, n):
    return rng.normal(scale=50.0, size=(n, 3)), Rotation.random(n, random_state=rng).as_matrix()


@pytest.mark.parametrize("about", ABOUT)
@pytest.mark.parametrize("reference", [PRISMS, FIVE], ids=["three", "five"])
def test_is_exact_without_noise(about, reference):
    rng = np.random.default_rng(1)
    positions, rotations = draw_poses(rng, 200)
    observed = move(reference, positions, rotations)
    p, R = find_pose(reference, observed, about=about)
    assert np.abs(p - positions).max() < 1e-8
    assert np.abs(R - rotations).max() < 1e-8
    assert np.allclose(np.linalg.det(R), 1.0, atol=1e-12)


@pytest.mark.parametrize("about", ABOUT)
def test_equals_scipy_with_noise(about):
    rng = np.random.default_rng(2)
    observed = move(FIVE, *draw_poses(rng, 50)) + rng.normal(scale=0.3, size=(50, 5, 3))
    p, R = find_pose(FIVE, observed, about=about)
    for k, points in enumerate(observed):
        if about == "first":
            a, b = points[1:] - points[0], FIVE[1:] - FIVE[0]
            there, here = points[0], FIVE[0]
        else:
            there, here = points.mean(axis=0), FIVE.mean(axis=0)
            a, b = points - there, FIVE - here
        expected = Rotation.align_vectors(a, b)[0].as_matrix()
        assert np.abs(R[k] - expected).max() < 1e-12
        assert np.abs(p[k] - (there - expected @ here)).max() < 1e-11


@pytest.mark.parametrize("about", ABOUT)
def test_a_reflected_start_gives_the_nearest_rotation(about):
    """Of mirrored points, no rotation found by chance is better, and the determinant is +1."""
    rng = np.random.default_rng(3)
    mirrored = FIVE * [1.0, 1.0, -1.0] + rng.normal(scale=0.1, size=(4, 5, 3))
    p, R = find_pose(FIVE, mirrored, about=about)
    assert np.allclose(np.linalg.det(R), 1.0, atol=1e-12)
    if about == "centroid":
        costs = [
            ((mirrored[0] - q - FIVE @ T.T) ** 2).sum()
            for d in Rotation.from_rotvec(rng.normal(scale=0.05, size=(500, 3))).as_matrix()
            for T in [R[0] @ d]
            for q in [np.mean(mirrored[0] - FIVE @ T.T, axis=0)]
        ]
        assert ((mirrored[0] - p[0] - FIVE @ R[0].T) ** 2).sum() < min(costs)
    # three prisms in a plane: the SVD alone leaves the sign of the determinant open
    R = find_pose(PRISMS, move(PRISMS, *draw_poses(rng, 100)), about=about)[1]
    assert np.allclose(np.linalg.det(R), 1.0, atol=1e-12)


def test_of_mirrored_planar_points_the_rotation_is_that_of_the_back():
    turned = PRISMS * [1.0, -1.0, 1.0]
    p, R = find_pose(PRISMS, turned[None])
    assert np.isclose(np.linalg.det(R[0]), 1.0)
    assert np.allclose(p + PRISMS @ R[0].T, turned, atol=1e-10)


def test_samples_without_all_points_are_nan():
    rng = np.random.default_rng(4)
    positions, rotations = draw_poses(rng, 6)
    observed = move(PRISMS, positions, rotations)
    observed[1, 2, 0], observed[4] = np.nan, np.inf
    p, R = find_pose(PRISMS, observed)
    bad = np.isin(np.arange(6), [1, 4])
    assert np.isnan(p[bad]).all()
    assert np.isnan(R[bad]).all()
    assert np.allclose(R[~bad], rotations[~bad], atol=1e-8)
    p, R = find_pose(PRISMS, np.full((2, 3, 3), np.nan))
    assert np.isnan(p).all()
    assert find_pose(PRISMS, np.empty((0, 3, 3)))[1].shape == (0, 3, 3)


def test_far_from_the_origin_nothing_is_lost():
    rng = np.random.default_rng(5)
    positions, rotations = draw_poses(rng, 20)
    positions += [5e5, 5.6e6, 30.0]  # UTM
    R = find_pose(PRISMS, move(PRISMS, positions, rotations))[1]
    assert np.abs(R - rotations).max() < 1e-8


def test_carries_points_to_positions():
    rng = np.random.default_rng(6)
    positions, rotations = draw_poses(rng, 30)
    root = np.array([-17.93, 0.0, 0.0])
    p, R = find_pose(PRISMS, move(PRISMS, positions, rotations))
    expected = move([root], positions, rotations)[:, 0]
    assert np.abs(carry_point(p, R, root) - expected).max() < 1e-8
    # a blade at rest: Eqs. 2 and 8 give the point's coordinates, no zeros
    assert np.allclose(carry_point(np.zeros((1, 3)), np.eye(3)[None], root), root)


LINE = np.array([[0.0, 0, 0], [1, 2, 3], [2, 4, 6]])


@pytest.mark.parametrize(
    ("reference", "observed", "message"),
    [
        (LINE, PRISMS[None], "the points of sample 0 are collinear"),
        (PRISMS, np.stack([PRISMS, LINE]), "the points of sample 1 are collinear"),
        (PRISMS, np.zeros((1, 3, 3)), "the points of sample 0 are collinear"),
    ],
)
def test_refuses_what_fixes_no_pose(reference, observed, message):
    with pytest.raises(InputError, match=message):
        find_pose(reference, observed)
