"""Angles of a blade: signs by scipy's rotations, rates by differences of matrices."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from experiments.maes2018.processing import find_angles_as_printed
from owtsweep.errors import InputError
from owtsweep.estimation.blade_angles import (
    find_angles,
    find_body_acceleration,
    find_body_rates,
    make_rotation,
)

UP = np.array([0.0, 0.0, 1.0])


def draw_angles(n=500, seed=1):
    return np.random.default_rng(seed).uniform([-3.1, -1.5, -3.1], [3.1, 1.5, 3.1], (n, 3))


def test_matrices_are_those_of_scipy_with_the_heading_reversed():
    angles = draw_angles()
    expected = Rotation.from_euler("ZYX", angles * [-1.0, 1.0, 1.0]).as_matrix()
    assert np.abs(make_rotation(angles) - expected).max() < 1e-14


def test_matrices_are_the_product_of_equation_3():
    for psi, theta, phi in draw_angles(5):
        (s, c), (st, ct), (sp, cp) = [(np.sin(a), np.cos(a)) for a in (psi, theta, phi)]
        T_psi = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        T_theta = np.array([[ct, 0, st], [0, 1, 0], [-st, 0, ct]])
        T_phi = np.array([[1, 0, 0], [0, cp, -sp], [0, sp, cp]])
        found = make_rotation(np.array([[psi, theta, phi]]))[0]
        assert np.allclose(found, T_psi @ T_theta @ T_phi, atol=1e-15)
        T_phi[0, 2] = 1.0  # as printed: no rotation
        assert not np.allclose(T_phi.T @ T_phi, np.eye(3), atol=0.1)


def test_signs_by_hand():
    """Clockwise from above is from x to -y; positive pitch lowers the tip; roll lifts +y."""
    small = 0.1
    heading, pitch, roll = make_rotation(np.diag([small] * 3))
    assert (heading @ [1.0, 0, 0])[1] < 0.0
    assert (pitch @ [1.0, 0, 0])[2] < 0.0
    assert (roll @ [0.0, 1, 0])[2] > 0.0


def test_angles_come_back():
    angles = draw_angles()
    assert np.abs(find_angles(make_rotation(angles)) - angles).max() < 1e-12
    assert np.array_equal(find_angles(np.eye(3)[None]), np.zeros((1, 3)))
    assert np.isnan(find_angles(np.full((1, 3, 3), np.nan))).all()


def test_a_steep_blade_keeps_its_matrix():
    rng = np.random.default_rng(2)
    angles = draw_angles()
    angles[:, 1] = rng.choice([-1.0, 1.0], len(angles)) * (np.pi / 2 - 10 ** rng.uniform(-17, -3))
    R = make_rotation(angles)
    assert np.abs(make_rotation(find_angles(R)) - R).max() < 1e-12


def test_the_printed_equations_agree_away_from_zero_only():
    rng = np.random.default_rng(3)
    size = rng.uniform(0.01, 1.4, (2000, 3)) * rng.choice([-1.0, 1.0], (2000, 3))
    R = make_rotation(size)
    printed, safe = find_angles_as_printed(R), find_angles(R)
    assert np.abs(printed - safe).max() < 1e-12
    assert np.abs(safe - size).max() < 1e-14
    # near 0 the arccos loses half of the digits, and all of an angle below 1e-8 rad
    near = 1e-6 * size
    R = make_rotation(near)
    assert np.abs(find_angles_as_printed(R) - near).max() > 1e-12
    assert np.abs(find_angles(R) - near).max() < 1e-15
    lost = find_angles_as_printed(make_rotation(np.full((1, 3), 1e-9)))
    assert np.array_equal(lost, np.zeros((1, 3)))


def test_the_printed_equations_never_give_nan():
    angles = np.random.default_rng(4).normal(scale=1e-8, size=(2000, 3))
    assert np.isfinite(find_angles_as_printed(make_rotation(angles))).all()


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


def test_a_level_blade_turning_clockwise_feels_a_negative_rate_about_z():
    w = find_body_rates(np.array([[1.0, 0.0, 0.0]]), np.array([[0.2, 0.0, 0.0]]))
    assert np.allclose(w, -0.2 * UP)


@pytest.mark.parametrize("find", [find_angles, find_angles_as_printed])
@pytest.mark.parametrize(
    ("rotations", "message"),
    [
        (np.stack([np.eye(3), 1.01 * np.eye(3)]), "rotations: matrix 1 is no rotation"),
        (np.diag([1.0, 1.0, -1.0])[None], "rotations: matrix 0 is no rotation.*determinant .1"),
        (np.full((1, 3, 3), np.inf), "rotations: matrix 0 is no rotation"),
        (np.eye(3), "rotations: have shape .3, 3.; .samples, 3, 3. would work"),
    ],
)
def test_refuses_what_is_no_rotation(find, rotations, message):
    with pytest.raises(InputError, match=message):
        find(rotations)
