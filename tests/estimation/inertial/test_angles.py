"""Euler angles: matrices by scipy's rotations, rates by differences of matrices."""

import numpy as np
from scipy.spatial.transform import Rotation

from owtsweep.estimation.inertial.angles import (
    find_angle_rates,
    find_angles,
    find_body_acceleration,
    find_body_rates,
    make_rotation,
)


def draw_angles(n=500, seed=1):
    return np.random.default_rng(seed).uniform([-3.1, -1.5, -3.1], [3.1, 1.5, 3.1], (n, 3))


def test_matrices_are_those_of_scipy():
    angles = draw_angles()
    expected = Rotation.from_euler("ZYX", angles[:, ::-1]).as_matrix()
    assert np.abs(make_rotation(angles) - expected).max() < 1e-14


def test_angles_come_back():
    angles = draw_angles()
    assert np.abs(find_angles(make_rotation(angles)) - angles).max() < 1e-12
    assert np.array_equal(find_angles(np.eye(3)[None]), np.zeros((1, 3)))


def test_a_steep_blade_keeps_its_matrix():
    rng = np.random.default_rng(2)
    angles = draw_angles()
    angles[:, 1] = rng.choice([-1.0, 1.0], len(angles)) * (np.pi / 2 - 10 ** rng.uniform(-17, -3))
    R = make_rotation(angles)
    assert np.abs(make_rotation(find_angles(R)) - R).max() < 1e-12


def test_small_angles_keep_their_digits():
    small = 1e-6 * np.random.default_rng(3).uniform(-1.4, 1.4, (2000, 3))
    assert np.abs(find_angles(make_rotation(small)) - small).max() < 1e-15


def motion(t):
    """Return angles and their first and second derivatives at times t, shape (samples, 3)."""
    sizes, speeds = np.array([0.9, 0.6, 0.4]), np.array([0.7, 1.1, 1.9])
    turn = np.outer(t, speeds) + np.array([0.1, 0.7, 1.9])
    return sizes * np.sin(turn), sizes * speeds * np.cos(turn), -sizes * speeds**2 * np.sin(turn)


def differentiate(find, t, h=1e-3):
    """Return a derivative by central differences of order 4."""
    return (8 * (find(t + h) - find(t - h)) - find(t + 2 * h) + find(t - 2 * h)) / (12 * h)


def test_body_rates_are_those_of_the_matrices():
    t = np.linspace(0.0, 20.0, 300)
    angles, rates, _ = motion(t)
    skew = np.swapaxes(make_rotation(angles), 1, 2) @ differentiate(
        lambda t: make_rotation(motion(t)[0]), t
    )
    expected = np.column_stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]])
    assert np.abs(find_body_rates(angles, rates) - expected).max() < 1e-9


def test_body_accelerations_are_derivatives_of_body_rates():
    t = np.linspace(0.0, 20.0, 300)
    expected = differentiate(lambda t: find_body_rates(*motion(t)[:2]), t)
    assert np.abs(find_body_acceleration(*motion(t)) - expected).max() < 1e-9


def test_rates_of_angles_come_back():
    angles, rates, _ = motion(np.linspace(0.0, 20.0, 300))
    found = find_angle_rates(angles, find_body_rates(angles, rates))
    assert np.abs(found - rates).max() < 1e-13
