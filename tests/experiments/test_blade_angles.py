"""Angles of a blade as Maes et al. (2018) have them: Eq. 3, Eqs. 9 to 11, signs by hand."""

import numpy as np

from experiments.maes2018.processing import find_angles_as_printed
from owtsweep.estimation.inertial.angles import (
    find_angles,
    find_body_rates,
    from_heading,
    make_rotation,
    to_heading,
)


def draw_angles(n=500, seed=1):
    return np.random.default_rng(seed).uniform([-3.1, -1.5, -3.1], [3.1, 1.5, 3.1], (n, 3))


def test_headings_come_back():
    angles = draw_angles()
    assert np.array_equal(to_heading(from_heading(angles)), angles)


def test_matrices_are_the_product_of_equation_3():
    for psi, theta, phi in draw_angles(5):
        (s, c), (st, ct), (sp, cp) = [(np.sin(a), np.cos(a)) for a in (psi, theta, phi)]
        T_psi = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        T_theta = np.array([[ct, 0, st], [0, 1, 0], [-st, 0, ct]])
        T_phi = np.array([[1, 0, 0], [0, cp, -sp], [0, sp, cp]])
        found = make_rotation(from_heading(np.array([[psi, theta, phi]])))[0]
        assert np.allclose(found, T_psi @ T_theta @ T_phi, atol=1e-15)
        T_phi[0, 2] = 1.0  # as printed: no rotation
        assert not np.allclose(T_phi.T @ T_phi, np.eye(3), atol=0.1)


def test_signs_by_hand():
    """Clockwise from above is from x to -y; positive pitch lowers the tip; roll lifts +y."""
    small = 0.1
    heading, pitch, roll = make_rotation(from_heading(np.diag([small] * 3)))
    assert (heading @ [1.0, 0, 0])[1] < 0.0
    assert (pitch @ [1.0, 0, 0])[2] < 0.0
    assert (roll @ [0.0, 1, 0])[2] > 0.0


def test_the_printed_equations_agree_away_from_zero_only():
    rng = np.random.default_rng(3)
    size = rng.uniform(0.01, 1.4, (2000, 3)) * rng.choice([-1.0, 1.0], (2000, 3))
    R = make_rotation(from_heading(size))
    printed, safe = find_angles_as_printed(R), to_heading(find_angles(R))
    assert np.abs(printed - safe).max() < 1e-12
    assert np.abs(safe - size).max() < 1e-14
    # near 0 the arccos loses half of the digits, and all of an angle below 1e-8 rad
    near = 1e-6 * size
    R = make_rotation(from_heading(near))
    assert np.abs(find_angles_as_printed(R) - near).max() > 1e-12
    assert np.abs(to_heading(find_angles(R)) - near).max() < 1e-15
    lost = find_angles_as_printed(make_rotation(from_heading(np.full((1, 3), 1e-9))))
    assert np.array_equal(lost, np.zeros((1, 3)))


def test_the_printed_equations_never_give_nan():
    angles = np.random.default_rng(4).normal(scale=1e-8, size=(2000, 3))
    assert np.isfinite(find_angles_as_printed(make_rotation(from_heading(angles)))).all()


def test_a_level_blade_turning_clockwise_feels_a_negative_rate_about_z():
    angles, rates = np.array([[1.0, 0.0, 0.0]]), np.array([[0.2, 0.0, 0.0]])
    w = find_body_rates(from_heading(angles), from_heading(rates))
    assert np.allclose(w, [0.0, 0.0, -0.2])
