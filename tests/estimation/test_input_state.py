"""Estimators of states and inputs against brute force, filterpy and closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from dense import Measurement, posterior
from scipy.integrate import solve_ivp
from scipy.linalg import block_diag, solve_discrete_are
from written_out import Case, WrittenOut, draw_case, walk

from owtsweep.errors import InputError
from owtsweep.estimation import input_state
from owtsweep.estimation.augmented import augment, make_augmented, make_lagged, make_steady
from owtsweep.estimation.discretisation import Discrete
from owtsweep.estimation.dual import make_dual
from owtsweep.estimation.gillijns import make_gillijns
from owtsweep.estimation.input_state import InputStateModel, hold_inputs
from owtsweep.estimation.latent import WIDE, make_latent

#: A beam's cut in small: a rigid translation (no stiffness), and a damped mode.
RIGID = np.array([[0.0, 0, 1, 0], [0, 0, 0, 1], [0, 0, 0, 0], [0, -90.0, 0, -0.3]])
DRIVE = np.array([[0.0, 0], [0, 0], [1, 0.4], [-0.7, 1]])
STEP = 0.01


def rigid(rows: tuple[int, ...] = (0, 1), scale: float = 1.0) -> InputStateModel:
    """The small cut; it measures these coordinates and both accelerations; inputs in 1/scale."""
    G = np.vstack([np.eye(4)[list(rows)], RIGID[2:]])
    J = np.vstack([np.zeros((len(rows), 2)), DRIVE[2:]])
    return hold_inputs(RIGID, DRIVE / scale, G, J / scale, STEP)


def test_inputs_are_held_where_the_matrix_is_singular() -> None:
    model = rigid()
    p, x0 = np.array([2.0, -1.0]), np.array([0.1, -0.2, 0.3, 0.4])
    fine = solve_ivp(lambda _, x: RIGID @ x + DRIVE @ p, (0.0, STEP), x0, rtol=1e-12, atol=1e-14).y[
        :, -1
    ]
    assert model.A @ x0 + model.B @ p == pytest.approx(fine, rel=1e-11)


def test_inputs_are_held_where_modes_are_stiffly_damped() -> None:
    model = hold_inputs(np.diag([-1e6, -1.0]), np.eye(2), np.eye(2), np.zeros((2, 2)), STEP)
    assert model.B[0, 0] == pytest.approx(1e-6)
    assert model.A[1, 1] == pytest.approx(np.exp(-STEP))


@pytest.mark.parametrize("seed", [1, 2])
def test_augmented_filter_is_dense_conditioning(seed: int) -> None:
    case = draw_case(seed)
    steps = len(case.y)
    made = make_augmented(case.model, case.Q, case.S, case.R, case.P0).run(case.y)
    dense = WrittenOut(case.model, case.Q, case.R, walk(case.P0, case.S, steps), steps)
    for k in range(steps):
        assert made[k] == pytest.approx(dense.estimate(case.y, k, k), rel=1e-8, abs=1e-8)


def test_augmented_filter_is_least_squares_over_twelve_orders_of_magnitude() -> None:
    # Inputs of 1e6 N beside displacements of 1e-3 m, priors of 1e6 beside sensors of 1e-14.
    model, steps = rigid(scale=1e6), 10
    Q, S, R = 1e-12 * np.eye(4), 1e10 * np.eye(2), np.diag([1e-14, 1e-14, 1e-8, 1e-8])
    P0 = block_diag(1e6 * np.eye(4), 1e13 * np.eye(2))
    random = np.random.default_rng(5)
    y = 1e-3 * np.cumsum(random.normal(size=(steps, 4)), axis=0)
    made = make_augmented(model, Q, S, R, P0).run(y)
    F, H = augment(model, np.eye(2))
    joint = Discrete(F, np.zeros((6, 1)), block_diag(Q, S), STEP)
    for last in (0, 3, steps - 1):
        measured = [
            Measurement(k, H[i], y[k, i], R[i, i]) for k in range(last + 1) for i in range(4)
        ]
        mean = posterior(joint, P0, np.zeros((last + 1, 1)), measured).mean[-1]
        size = np.array([1e-3, 1e-3, 1e-1, 1e-1, 1e6, 1e6])
        assert made[last] / size == pytest.approx(mean / size, rel=1e-8, abs=1e-8)


def test_runs_are_filterpy_s_beyond_the_settling_of_gains() -> None:
    from filterpy.kalman import KalmanFilter

    case = draw_case(3, steps=400)
    made = make_augmented(case.model, case.Q, case.S, case.R, case.P0)
    assert made.settled
    assert len(made.early_K) < 200
    F, H = augment(case.model, np.eye(2))
    peer = KalmanFilter(dim_x=6, dim_z=3)
    peer.F, peer.H, peer.R, peer.P = F, H, case.R, case.P0
    peer.Q = block_diag(case.Q, case.S)
    result = made.run(case.y)
    for k, y in enumerate(case.y):
        peer.predict()
        peer.update(y)
        assert result[k] == pytest.approx(peer.x.ravel(), rel=1e-9, abs=1e-8)
    assert made.run(case.y[:5]) == pytest.approx(result[:5], rel=1e-14)


def test_steady_filter_is_the_limit_whether_or_not_all_is_seen() -> None:
    Q, S, P0 = 1e-3 * np.eye(4), np.eye(2), np.eye(6)
    for rows, fades in (((0, 1), True), ((1,), False)):
        model, R = rigid(rows), np.eye(2 + len(rows)) * 1e-2
        limit, made = make_augmented(model, Q, S, R, P0), make_steady(model, Q, S, R)
        assert limit.settled
        assert made.settled
        assert len(made.early_K) == 1
        seen = slice(None) if fades else [1, 3, 4, 5]
        assert made.K[seen] == pytest.approx(limit.K[seen], rel=1e-5, abs=1e-7)
        assert (made.radius < 0.999) == fades
    # position and velocity of the translation: two eigenvalues of 1, though PBH lacks one
    assert np.sum(np.abs(np.linalg.eigvals(limit.F)) > 1.0 - 1e-6) == 2


def test_steady_filter_does_not_trust_a_solution_that_does_not_fade() -> None:
    # In these coordinates scipy solves the Riccati equation, though it has no solution.
    model, T = rigid((1,)), np.random.default_rng(1).normal(size=(4, 4))
    back = np.linalg.inv(T)
    mixed = InputStateModel(back @ model.A @ T, back @ model.B, model.G @ T, model.J, STEP)
    Q, S, R = 1e-3 * back @ back.T, np.eye(2), 1e-2 * np.eye(3)
    F, H = augment(mixed, np.eye(2))
    solve_discrete_are(F.T, H.T, block_diag(Q, S), R)
    made = make_steady(mixed, Q, S, R)
    plain = make_steady(model, 1e-3 * np.eye(4), S, R)
    seen = block_diag(T, np.eye(2)) @ made.K
    assert seen[[1, 3, 4, 5]] == pytest.approx(plain.K[[1, 3, 4, 5]], rel=1e-5, abs=1e-7)


def test_gains_that_do_not_settle_stay_as_they_are(monkeypatch) -> None:
    monkeypatch.setattr(input_state, "LONGEST", 7)
    case = draw_case(3, steps=20)
    made = make_augmented(case.model, case.Q, case.S, case.R, case.P0)
    assert not made.settled
    assert len(made.early_K) == 7
    x = made.run(case.y)
    assert x[12] == pytest.approx(made.F @ x[11] + made.K @ case.y[12])


@pytest.mark.parametrize("lag", [0, 3, 40])
def test_lagged_estimates_are_dense_conditioning(lag: int) -> None:
    case = draw_case(4, steps=12)
    made = make_lagged(case.model, case.Q, case.S, case.R, case.P0, lag).run(case.y)
    dense = WrittenOut(case.model, case.Q, case.R, walk(case.P0, case.S, 12), 12)
    for k in range(12):
        expected = dense.estimate(case.y, k, min(k + lag, 11))
        assert made[k] == pytest.approx(expected, rel=1e-8, abs=1e-8)


def test_lagged_estimates_keep_on_after_gains_have_settled(monkeypatch) -> None:
    case = draw_case(4, steps=90)
    made = make_lagged(case.model, case.Q, case.S, case.R, case.P0, 6)
    rows = len(made.predicted)
    assert made.settled
    assert rows < 70
    dense = WrittenOut(case.model, case.Q, case.R, walk(case.P0, case.S, 90), 90)
    whole = made.run(case.y)
    monkeypatch.setattr("owtsweep.estimation.lagged.CHUNK", 7)
    assert made.run(case.y) == pytest.approx(whole, rel=1e-12, abs=1e-12)
    for k in (rows // 4, rows - 8, rows - 2, rows - 1, rows, 80, 89):
        expected = dense.estimate(case.y, k, min(k + 6, 89))
        assert whole[k] == pytest.approx(expected, rel=1e-6, abs=1e-7)


def square() -> Case:
    """A case with as many measurements as inputs, and an invertible feedthrough."""
    return draw_case(6, n=3, inputs=3, m=3)


def test_gillijns_filter_inverts_a_model_without_noise() -> None:
    case = square()
    A, B, G, J = case.model.A, case.model.B, case.model.G, case.model.J
    filtered = make_gillijns(case.model, case.Q, case.R, np.zeros((3, 3))).run(case.y)
    x = np.zeros(3)  # the closed form: p = J^-1 (y - G x)
    for k, y in enumerate(case.y):
        p = np.linalg.solve(J, y - G @ x)
        assert filtered[k] == pytest.approx(np.concatenate([x, p]), rel=1e-9, abs=1e-9)
        x = A @ x + B @ p


def test_gillijns_filter_is_unbiased_for_any_input() -> None:
    case = draw_case(7, n=4, inputs=2, m=4)
    steps = 60
    p = 1e3 * np.random.default_rng(1).normal(size=(steps, 2)) + 5e3
    x = np.zeros((steps, 4))
    for k in range(1, steps):
        x[k] = case.model.A @ x[k - 1] + case.model.B @ p[k - 1]
    y = x @ case.model.G.T + p @ case.model.J.T  # what is measured on average
    filtered = make_gillijns(case.model, case.Q, case.R, case.P0[:4, :4]).run(y)
    assert filtered == pytest.approx(np.hstack([x, p]), rel=1e-8, abs=1e-6)


def test_gillijns_filter_is_the_filter_that_believes_nothing_of_inputs() -> None:
    case = draw_case(7, n=4, inputs=2, m=4)
    P0 = case.P0[:4, :4]
    steps = len(case.y)
    made = make_gillijns(case.model, case.Q, case.R, P0).run(case.y)
    # rows of one least squares problem: prior, dynamics, measurements; none for the inputs
    A, B, G, J = case.model.A, case.model.B, case.model.G, case.model.J
    prior, process, noise = (np.linalg.cholesky(np.linalg.inv(c)).T for c in (P0, case.Q, case.R))
    for last in (0, 4, steps - 1):
        rows, right = [np.hstack([prior, np.zeros((4, 6 * (last + 1) - 4))])], [np.zeros(4)]
        for k in range(last + 1):
            row = np.zeros((8 if k < last else 4, 6 * (last + 1)))
            row[:4, 6 * k : 6 * k + 6] = noise @ np.hstack([G, J])
            if k < last:
                row[4:, 6 * k : 6 * k + 6] = -process @ np.hstack([A, B])
                row[4:, 6 * k + 6 : 6 * k + 10] = process
            rows.append(row)
            right += [noise @ case.y[k], np.zeros(len(row) - 4)]
        best = np.linalg.lstsq(np.vstack(rows), np.concatenate(right))[0]
        assert made[last] == pytest.approx(best[-6:], rel=1e-7, abs=1e-7)


def test_units_of_inputs_do_not_matter_to_gillijns_filter() -> None:
    pair = [make_gillijns(rigid(scale=s), np.eye(4), np.eye(4), np.eye(4)) for s in (1.0, 1e12)]
    unit = np.array([[1.0]] * 4 + [[1e12]] * 2)  # of states and of inputs
    assert pair[1].K / unit == pytest.approx(pair[0].K, rel=1e-9, abs=1e-12)


def test_dual_filter_is_two_textbook_filters() -> None:
    case = draw_case(8)
    A, B, G, J = case.model.A, case.model.B, case.model.G, case.model.J
    Px, Pp = case.P0[:4, :4], case.P0[4:, 4:]
    made = make_dual(case.model, case.Q, case.S, case.R, Px, Pp)
    filtered = made.run(case.y)
    x, p = np.zeros(4), np.zeros(2)
    for k, y in enumerate(case.y):
        predicted = A @ x + B @ p
        Pp = Pp + case.S
        K = Pp @ J.T @ np.linalg.inv(J @ Pp @ J.T + case.R)
        p = p + K @ (y - G @ predicted - J @ p)
        Pp = Pp - K @ J @ Pp
        Px = A @ Px @ A.T + case.Q
        K = Px @ G.T @ np.linalg.inv(G @ Px @ G.T + case.R)
        x = predicted + K @ (y - G @ predicted - J @ p)
        Px = Px - K @ G @ Px
        assert filtered[k] == pytest.approx(np.concatenate([x, p]), rel=1e-8, abs=1e-8)


def test_radius_tells_whether_an_error_grows() -> None:
    model, Q, S, R = rigid(), 1e-3 * np.eye(4), np.eye(2), 1e-2 * np.eye(4)
    made = make_dual(model, Q, S, R, np.eye(4), np.eye(2))
    assert made.settled
    kick = np.zeros((3000, 4))
    kick[0] = 1.0
    x = np.linalg.norm(made.run(kick), axis=1)
    rate = (x[2999] / x[1999]) ** (1.0 / 1000.0)
    assert made.radius == pytest.approx(rate, rel=1e-3)
    steady = make_augmented(model, Q, S, R, np.eye(6))
    assert steady.radius < 1.0


@pytest.mark.parametrize("kernel", ["matern12", "matern32"])
def test_latent_filter_is_gaussian_process_regression(kernel) -> None:
    case, steps = draw_case(9), 12
    sigma, length = np.array([2.0, 0.7]), np.array([0.5, 0.11])
    times = case.model.step * np.arange(steps + 1)
    before = np.zeros((4 + 2 * (steps + 1),) * 2)
    before[:4, :4] = WIDE * np.eye(4)
    for i in range(2):
        r = np.abs(times[:, None] - times) / length[i]
        a = np.sqrt(3.0) * r
        shape = np.exp(-r) if kernel == "matern12" else (1.0 + a) * np.exp(-a)
        before[4 + i :: 2, 4 + i :: 2] = sigma[i] ** 2 * shape
    dense = WrittenOut(case.model, case.Q, case.R, before, steps)
    made = make_latent(case.model, case.Q, case.R, kernel, sigma, length)
    filtered = made.run(case.y)
    for k in range(steps):
        assert filtered[k] == pytest.approx(dense.estimate(case.y, k, k), rel=1e-8, abs=1e-8)


def test_noise_that_is_singular_is_refused() -> None:
    case = draw_case(3)
    with pytest.raises(InputError, match="R: the covariance of the sensors' noise is singular"):
        make_augmented(case.model, case.Q, case.S, np.diag([0.0, 1, 1]), case.P0)
