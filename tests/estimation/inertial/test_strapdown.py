"""The strapdown kernels by brute force: rotation matrices, differences, a dense Kalman filter."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from owtsweep.estimation.inertial.angles import find_body_rates
from owtsweep.estimation.inertial.attitude import lean, read_angles, rotate, turn
from owtsweep.estimation.inertial.invariant import carry_body, correct_body
from owtsweep.estimation.inertial.reports import push
from owtsweep.estimation.inertial.strapdown import (
    ERRORS,
    GYROSCOPES,
    RATE_AS_STATE,
    STATES,
    add_noise,
    carry,
    correct,
    learn,
    linearise,
    move,
    place,
    predict,
    subtract,
)


def make_matrix(s):
    """Return the attitude's matrix of a state."""
    return Rotation.from_quat(s[6:10], scalar_first=True).as_matrix()


def cross(v):
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def draw_state(rng):
    """Return a state that is anywhere."""
    s = rng.normal(size=STATES)
    s[6:10] /= np.linalg.norm(s[6:10])
    s[10:] *= 0.1
    return s


def draw_covariance(rng):
    root = rng.normal(size=(ERRORS, ERRORS))
    return root @ root.T


def differentiate(carried, s, moved, change=correct):
    """Return by what errors put into s change those of the carried state, by differences."""
    columns, h = [], 1e-5
    for error in np.eye(ERRORS):
        ends = []
        for sign in (1.0, -1.0):
            near, found = s.copy(), np.empty(ERRORS)
            change(near, sign * h * error)
            carried(near)
            subtract(near, moved, found)
            ends.append(found)
        columns.append((ends[0] - ends[1]) / (2.0 * h))
    return np.stack(columns, axis=1)


def test_quaternions_are_those_of_rotation_matrices():
    rng = np.random.default_rng(1)
    for _ in range(5):
        angles = rng.uniform([-3.0, -1.4, -3.0], [3.0, 1.4, 3.0])
        q = Rotation.from_euler("ZYX", angles[::-1]).as_quat(scalar_first=True)
        R, turned, T, found = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
        rotate(q, R)
        assert np.allclose(R, Rotation.from_euler("ZYX", angles[::-1]).as_matrix(), atol=1e-14)
        read_angles(q, found, T)
        assert np.allclose(found, angles, atol=1e-12)
        rates = rng.normal(size=(1, 3))
        body = find_body_rates(angles[None], rates)[0]
        assert np.allclose(T @ body, rates[0], atol=1e-10)
        v = rng.normal(size=3)
        turn(q, *v)
        rotate(q, turned)
        assert np.allclose(turned, R @ expm(cross(v)), atol=1e-13)


def test_errors_put_in_are_those_that_come_out():
    rng = np.random.default_rng(5)
    base, dx = draw_state(rng), 0.3 * rng.normal(size=ERRORS)
    s, found = base.copy(), np.empty(ERRORS)
    correct(s, dx)
    assert np.allclose(make_matrix(s), make_matrix(base) @ expm(cross(dx[6:9])), atol=1e-14)
    subtract(s, base, found)
    assert found == pytest.approx(dx, abs=1e-14)
    s[6:10] *= -1.0  # the same attitude
    subtract(s, base, found)
    assert found == pytest.approx(dx, abs=1e-14)


@pytest.mark.parametrize("model", [GYROSCOPES, RATE_AS_STATE])
def test_a_state_moves_as_its_equations_say(model):
    """One step against a thousand small ones of Euler's method."""
    rng = np.random.default_rng(6)
    s, d, steps = draw_state(rng), 0.01, 1000
    force, rate = rng.normal(size=3) * 5.0 + rng.normal(size=(2, 3)) * 0.1, rng.normal(size=3) * 0.3
    p, v, R = s[:3].copy(), s[3:6].copy(), make_matrix(s)
    w = rate + model.sign * s[13:16]
    for k in range(steps):
        f = force[0] + (k + 0.5) / steps * (force[1] - force[0]) - s[10:13]
        a = R @ f + [0.0, 0.0, model.gravity]
        p, v, R = p + d / steps * v, v + d / steps * a, R @ expm(cross(w * d / steps))
    moved = s.copy()
    move(moved, d, *force, rate, model, *np.empty((2, 3, 3)))
    assert moved[:3] == pytest.approx(p, abs=1e-6)
    assert moved[3:6] == pytest.approx(v, abs=1e-5)
    assert make_matrix(moved) == pytest.approx(R, abs=1e-12)
    assert moved[10:] == pytest.approx(s[10:])


@pytest.mark.parametrize("model", [GYROSCOPES, RATE_AS_STATE])
@pytest.mark.parametrize("step", [0.02, 0.002])
def test_errors_move_as_states_do(step, model):
    """By central differences; what is left out is of the second order of the step."""
    rng = np.random.default_rng(5)
    s, moved = draw_state(rng), None
    force, rate = rng.normal(size=(2, 3)) * 5.0, rng.normal(size=3) * 0.3
    ends, M, R, back = np.empty((2, 3, 3)), *np.empty((3, 3, 3))

    def carried(state):
        move(state, step, *force, rate, model, *ends)

    moved = s.copy()
    carried(moved)
    linearise(s, *force, *ends, M, R, back)
    F = np.eye(ERRORS)
    carry(F, step, M, R, back, model)
    assert np.abs(F - differentiate(carried, s, moved)).max() < 6.0 * step**2
    P = draw_covariance(rng)
    expected = F @ P @ F.T
    predict(s.copy(), P, step, *force, rate, model)
    assert pytest.approx(expected, abs=1e-12 * np.abs(expected).max()) == P
    assert np.array_equal(P, P.T)


def test_errors_in_the_bodys_frame_move_as_states_do():
    rng = np.random.default_rng(5)
    s, step = draw_state(rng), 0.002
    f, w = rng.normal(size=3) * 5.0, rng.normal(size=3) * 0.3

    def carried(state):
        move(state, step, f, f, w, GYROSCOPES, *np.empty((2, 3, 3)))

    moved = s.copy()
    carried(moved)
    old, new = make_matrix(s), make_matrix(moved)
    F, turned = np.eye(ERRORS), np.eye(ERRORS)
    carry_body(F, step, f - s[10:13], new.T @ old)
    turned[:3, :3] = turned[3:6, 3:6] = new.T
    numeric = turned @ differentiate(carried, s, moved, correct_body)
    assert np.abs(F - numeric).max() < 1e-4


def test_noise_is_that_of_white_noise_between_the_ends():
    """Q of many small steps, carried to the end, is Q of one step."""
    steps, d = 1000, 0.1
    noise = np.array([0.5, 0.0, 0.0, 0.0])
    Q, small = np.zeros((ERRORS, ERRORS)), np.zeros((ERRORS, ERRORS))
    add_noise(Q, d, noise)
    F = np.eye(ERRORS)
    F[:3, 3:6] = d / steps * np.eye(3)
    for _ in range(steps):
        small = F @ small @ F.T
        small[3:6, 3:6] += noise[0] * d / steps * np.eye(3)
    assert np.allclose(Q, small, rtol=5e-3, atol=0.0)


def test_the_covariance_of_reports_is_carried_as_errors_are():
    """F P F' + Q with F by finite differences of the prediction, Q by its closed form."""
    rng = np.random.default_rng(2)
    s, d = draw_state(rng), 0.002
    first, last = rng.normal(size=(2, 3)) - [0.0, 0.0, RATE_AS_STATE.gravity]
    noise = rng.uniform(0.5, 1.0, (3, 3))
    P = draw_covariance(rng)

    def carried(state):
        push(state, np.zeros((ERRORS, ERRORS)), d, first, last, noise)

    moved = s.copy()
    carried(moved)
    F = differentiate(carried, s, moved)
    Q = np.zeros((15, 15))
    for i in range(3):
        for k, v, q in ((i, 3 + i, noise[0, i]), (6 + i, 12 + i, noise[1, i])):
            Q[k, k], Q[v, v] = q * d**3 / 3.0, q * d
            Q[k, v] = Q[v, k] = q * d**2 / 2.0
        Q[9 + i, 9 + i] = noise[2, i] * d
    found = P.copy()
    push(s.copy(), found, d, first, last, noise)
    # Errors of rates move positions in the second order of d only, which the filter leaves out.
    assert np.allclose(found - P, F @ P @ F.T + Q - P, atol=2e-3 * np.abs(F @ P @ F.T - P).max())
    assert np.allclose(found, found.T, atol=1e-9)


def test_corrections_are_those_of_a_dense_kalman_filter():
    """Two measurements, one after the other, against both at once."""
    rng = np.random.default_rng(3)
    root = rng.normal(size=(15, 15))
    P, H, e, R = root @ root.T, rng.normal(size=(2, 15)), rng.normal(size=2), np.array([0.3, 0.7])
    found, dx = P.copy(), np.zeros(15)
    nis = sum(learn(found, dx, H[i], e[i], R[i]) for i in range(2))
    S = H @ P @ H.T + np.diag(R)
    gain = P @ H.T @ np.linalg.inv(S)
    assert np.allclose(dx, gain @ e)
    assert np.allclose(found, P - gain @ S @ gain.T)
    assert nis == pytest.approx(e @ np.linalg.solve(S, e))


def test_a_point_of_the_body_moves_with_the_attitude_as_its_row_says():
    s, lever, h = draw_state(np.random.default_rng(7)), np.array([-2.0, 0.5, 1.0]), 1e-6
    H, at, numeric = np.empty((3, 3)), np.empty(3), np.empty((3, 3))
    lean(make_matrix(s), lever, H)
    place(s, make_matrix(s), lever, at)
    for j in range(3):
        near, there = s.copy(), np.empty(3)
        correct(near, h * np.eye(ERRORS)[6 + j])
        place(near, make_matrix(near), lever, there)
        numeric[:, j] = (there - at) / h
    assert pytest.approx(numeric, abs=1e-5) == H
