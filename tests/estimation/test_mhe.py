"""The moving horizon estimator: as least squares, as a Kalman filter, as CasADi solves it."""

from __future__ import annotations

import numpy as np
import pytest
from dense import Array, whitener

from owtsweep.estimation.casadi_window import CasadiWindow
from owtsweep.estimation.mhe import WindowWeights, square_root_information, window_maps

T = 1.0
Q_F, Q_B = 2.25e-4, 1e-6
WEIGHTS = WindowWeights(
    transition=np.array([[1.0, T, T**2 / 2], [0.0, 1.0, T], [0.0, 0.0, 1.0]]),
    link_covariance=np.array(
        [
            [Q_F * T**3 / 3 + Q_B * T**5 / 20, Q_F * T**2 / 2 + Q_B * T**4 / 8, Q_B * T**3 / 6],
            [Q_F * T**2 / 2 + Q_B * T**4 / 8, Q_F * T + Q_B * T**3 / 3, Q_B * T**2 / 2],
            [Q_B * T**3 / 6, Q_B * T**2 / 2, Q_B * T],
        ]
    ),
    fix_variance=9e-4,
)
ARRIVAL = np.array([[2e-3, 1e-4, 0.0], [1e-4, 1e-3, -1e-5], [0.0, -1e-5, 4e-4]])


def data(intervals: int) -> tuple[Array, Array, Array]:
    """Fixes (intervals + 1,), effects of the inputs (intervals, 3), arrival state (3,)."""
    random = np.random.default_rng(intervals)
    return (
        random.normal(size=intervals + 1),
        random.normal(size=(intervals, 3)) * [0.5, 1.0, 0.0],
        random.normal(size=3) * [0.1, 0.1, 0.01],
    )


def apply(G: Array, z: Array, effects: Array, x0: Array) -> Array:
    return np.asarray(G @ np.concatenate([z, effects.ravel(), x0]))


@pytest.mark.parametrize("use_first_fix", [True, False])
@pytest.mark.parametrize("arrival", [True, False])
@pytest.mark.parametrize("intervals", [3, 8])
def test_map_is_the_least_squares_solution(
    intervals: int, arrival: bool, use_first_fix: bool
) -> None:
    z, effects, x0 = data(intervals)
    size = 3 * (intervals + 1)
    rows, values = [], []

    def add(block: dict[int, Array], value: Array) -> None:
        row = np.zeros((len(value), size))
        for node, matrix in block.items():
            row[:, 3 * node : 3 * node + 3] = matrix
        rows.append(row)
        values.append(value)

    for i in range(0 if use_first_fix else 1, intervals + 1):
        add({i: np.array([[1.0, 0.0, 0.0]]) / 0.03}, z[[i]] / 0.03)
    half = whitener(WEIGHTS.link_covariance)
    for i in range(intervals):
        add({i: -half @ WEIGHTS.transition, i + 1: half}, half @ effects[i])
    if arrival:
        half = whitener(ARRIVAL)
        add({0: half}, half @ x0)
    solution = np.linalg.lstsq(np.vstack(rows), np.concatenate(values), rcond=None)[0][-3:]
    priors = [ARRIVAL if arrival else None]
    [G] = window_maps(WEIGHTS, intervals, priors, use_first_fix=use_first_fix)
    np.testing.assert_allclose(apply(G, z, effects, x0), solution, rtol=1e-9, atol=1e-10)


@pytest.mark.parametrize("intervals", [0, 1, 5])
def test_with_the_kalman_arrival_cost_it_is_the_kalman_filter(intervals: int) -> None:
    z, effects, x0 = data(intervals)
    [G] = window_maps(WEIGHTS, intervals, [ARRIVAL])
    H, A = np.array([1.0, 0.0, 0.0]), WEIGHTS.transition
    x, P = x0, ARRIVAL  # predicted mean and covariance of the oldest node
    for i in range(intervals + 1):
        K = P @ H / (H @ P @ H + WEIGHTS.fix_variance)
        x, P = x + K * (z[i] - H @ x), P - np.outer(K, H @ P)
        if i < intervals:
            x, P = A @ x + effects[i], A @ P @ A.T + WEIGHTS.link_covariance
    np.testing.assert_allclose(apply(G, z, effects, x0), x, rtol=1e-9, atol=1e-10)


def test_arrival_that_holds_the_oldest_fix_leaves_that_fix_out() -> None:
    # the filtered state as arrival, without its fix, is the predicted state with it
    z, effects, x0 = data(4)
    H = np.array([1.0, 0.0, 0.0])
    K = ARRIVAL @ H / (H @ ARRIVAL @ H + WEIGHTS.fix_variance)
    filtered, P = x0 + K * (z[0] - H @ x0), ARRIVAL - np.outer(K, H @ ARRIVAL)
    [predicted] = window_maps(WEIGHTS, 4, [ARRIVAL])
    [held] = window_maps(WEIGHTS, 4, [P], use_first_fix=False)
    np.testing.assert_allclose(
        apply(held, z, effects, filtered), apply(predicted, z, effects, x0), rtol=1e-9
    )
    assert np.all(held[:, 0] == 0.0)


@pytest.mark.parametrize("arrival", [True, False])
def test_an_undetermined_window_is_refused(arrival: bool) -> None:
    with pytest.raises(ValueError, match="do not determine"):
        next(window_maps(WEIGHTS, 0 if arrival else 1, [None], use_first_fix=not arrival))


@pytest.mark.parametrize("fixed", [False, True])
@pytest.mark.parametrize("intervals", [1, 7])
def test_windows_made_together_are_those_made_alone(intervals: int, fixed: bool) -> None:
    arrivals = [None] * 3 if fixed else [ARRIVAL, 2.0 * np.eye(3), ARRIVAL]
    kind = {"fixed_arrival": fixed, "use_first_fix": False}
    together = list(window_maps(WEIGHTS, intervals, arrivals, **kind))
    alone = [next(window_maps(WEIGHTS, intervals, [P], **kind)) for P in arrivals]
    np.testing.assert_array_equal(together, alone)
    assert fixed or not np.array_equal(together[0], together[1])


@pytest.mark.parametrize("intervals", [0, 1, 6])
def test_a_fixed_arrival_is_a_certain_one(intervals: int) -> None:
    z, effects, x0 = data(intervals)
    [fixed] = window_maps(WEIGHTS, intervals, [None], fixed_arrival=True, use_first_fix=False)
    [certain] = window_maps(WEIGHTS, intervals, [1e-18 * np.eye(3)], use_first_fix=False)
    expected = apply(certain, z, effects, x0)
    np.testing.assert_allclose(apply(fixed, z, effects, x0), expected, rtol=1e-6, atol=1e-7)


CASES = {
    "prior": (ARRIVAL, {}, {"arrival": True}),
    "fixed": (
        None,
        {"fixed_arrival": True, "use_first_fix": False},
        {"arrival": False, "fixed_arrival": True, "use_first_fix": False},
    ),
    "none": (None, {}, {"arrival": False}),
}


@pytest.mark.parametrize(("solver", "tolerance"), [("qrqp", 1e-9), ("ipopt", 1e-6)])
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("decades", [0.0, 4.0])
def test_casadi_finds_the_map(solver: str, tolerance: float, case: str, decades: float) -> None:
    # `decades` spreads the link's weights as REPRODUCTION.md's leads do
    z, effects, x0 = data(6)
    spread = 10.0 ** np.array([decades / 4, 0.0, -decades / 2])
    weights = WindowWeights(
        WEIGHTS.transition, WEIGHTS.link_covariance * np.outer(spread, spread), WEIGHTS.fix_variance
    )
    arrival, for_map, for_casadi = CASES[case]
    [G] = window_maps(weights, 6, [arrival], **for_map)
    tf = 0.4
    A_f = np.array([[1.0, tf, tf**2 / 2], [0.0, 1.0, tf], [0.0, 0.0, 1.0]])
    last = np.array([0.02, 0.1, 0.0])
    problem = CasadiWindow(6, states=3, outputs=1, last_node=True, solver=solver, **for_casadi)
    deviation = np.sqrt(np.diagonal(weights.link_covariance))
    nodes = problem.solve(
        np.array([0.03, deviation[1], deviation[2]]),
        z[None, :],
        np.vstack([effects, last]).T,
        A=weights.transition,
        A_f=A_f,
        link=square_root_information(weights.link_covariance),
        fix=1.0 / 0.03,
        x0=x0,
        prior=square_root_information(ARRIVAL),
        rows=np.zeros((0, 3)),
        lower=np.zeros(0),
        upper=np.zeros(0),
    )
    expected = apply(G, z, effects, x0)
    assert np.max(np.abs(nodes[:, 6] - expected)) <= tolerance * np.max(np.abs(expected))
    expected = A_f @ expected + last
    assert np.max(np.abs(nodes[:, 7] - expected)) <= tolerance * np.max(np.abs(expected))


def test_casadi_refuses_other_solvers() -> None:
    with pytest.raises(ValueError, match="solver is 'osqp'"):
        CasadiWindow(2, states=3, outputs=1, last_node=False, arrival=False, solver="osqp")


def test_square_root_information() -> None:
    U = square_root_information(ARRIVAL)
    np.testing.assert_allclose(U.T @ U @ ARRIVAL, np.eye(3), atol=1e-12)
