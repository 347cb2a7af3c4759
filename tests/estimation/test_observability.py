"""What sensors do not see, on constructed models with known answers."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import block_diag, expm

from owtsweep.estimation.augmented import augment, make_augmented
from owtsweep.estimation.input_state import InputStateModel
from owtsweep.estimation.observability import Observability, find_unobservable

STEP = 0.01
#: Translation and rotation of a free body, a slow bending mode: coordinates, then their rates.
FREE = np.zeros((6, 6))
FREE[:3, 3:] = np.eye(3)
FREE[5, 2], FREE[5, 5] = -90.0, -0.3
INCLINOMETERS = [[0.0, 1, 0.3, 0, 0, 0], [0.0, 1, -0.8, 0, 0, 0]]
#: Without loads, rigid motion has no acceleration.
ACCELEROMETERS = [[0.0, 0, -90.0, 0, 0, -0.3]]
POSITION = [[1.0, 0, 0.5, 0, 0, 0]]


def see(*rows: list[list[float]], mixed: bool = False, held: bool = True) -> Observability:
    """What sensors see of the free body, in the given or in random coordinates."""
    A, G = expm(FREE * STEP) if held else FREE, np.vstack(rows)
    if mixed:
        T = np.random.default_rng(1).normal(size=(6, 6))
        A, G = np.linalg.solve(T, A @ T), G @ T
    return find_unobservable(A, G)


@pytest.mark.parametrize("mixed", [False, True])
@pytest.mark.parametrize("held", [False, True])
def test_the_chain_of_a_rigid_translation_is_found(mixed: bool, held: bool) -> None:
    found = see(INCLINOMETERS, ACCELEROMETERS, mixed=mixed, held=held)
    assert found.rank == 4
    [unseen] = found.unseen
    assert unseen.lacking == 1
    assert unseen.count == 2
    assert unseen.eigenvalue == pytest.approx(1.0 if held else 0.0, abs=1e-6)


def test_unseen_directions_are_position_then_velocity() -> None:
    [unseen] = see(INCLINOMETERS, ACCELEROMETERS).unseen
    assert np.abs(unseen.directions.T) == pytest.approx(np.eye(6)[[0, 3]], abs=1e-9)


def test_accelerometers_alone_miss_four_directions_in_two_chains() -> None:
    found = see(ACCELEROMETERS)
    assert (found.rank, found.unseen[0].lacking, found.unseen[0].count) == (2, 2, 4)


@pytest.mark.parametrize("mixed", [False, True])
def test_one_position_completes_the_view(mixed: bool) -> None:
    found = see(INCLINOMETERS, POSITION, mixed=mixed)
    assert found.unseen == ()
    assert found.rank == 6


def test_the_rank_is_that_of_the_observability_matrix() -> None:
    random = np.random.default_rng(7)
    for hidden in (0, 1, 2, 3):
        A = random.normal(size=(6, 6))
        A[: 6 - hidden, 6 - hidden :] = 0.0  # the first states never feel the hidden ones
        G = np.hstack([random.normal(size=(2, 6 - hidden)), np.zeros((2, hidden))])
        T = random.normal(size=(6, 6))
        A, G = np.linalg.solve(T, A @ T), G @ T
        powers = np.vstack([G @ np.linalg.matrix_power(A, k) for k in range(6)])
        found = find_unobservable(A, G)
        assert found.rank == np.linalg.matrix_rank(powers, tol=1e-7) == 6 - hidden
        for unseen in found.unseen:
            assert powers @ unseen.directions == pytest.approx(0.0, abs=1e-6)


def test_a_mode_with_a_node_at_the_sensor_is_unseen() -> None:
    rate = 2.0 * np.pi * 1.5
    A = expm(block_diag([[0, 1], [-4.0, 0]], [[0, 1], [-(rate**2), 0]]) * STEP)
    found = find_unobservable(A, np.array([[1.0, 0, 0, 0]]))
    assert found.rank == 2
    assert found.unseen[0].count == 2


def test_units_do_not_matter() -> None:
    A, G = expm(FREE * STEP), np.array(INCLINOMETERS + ACCELEROMETERS)
    found = find_unobservable(A, G * np.array([1e10, 1.0, 1e-10])[:, None])
    assert (found.rank, found.unseen[0].lacking) == (4, 1)


def test_what_is_unseen_stays_in_the_augmented_filter() -> None:
    drive = np.array([[1.0, 0.2], [0.1, 0.5], [0.4, -0.6]])
    B = np.vstack([0.5 * STEP**2 * drive, STEP * drive])
    for rows, J in ((INCLINOMETERS, 0.0), (POSITION, 0.0), (INCLINOMETERS[:1], 1.0)):
        G = np.array(rows + [[0.0, 0, -90.0 * s, 0, 0, -0.3 * s] for s in (0.5, -0.6, 0.1)])
        feed = np.vstack([np.zeros((len(rows), 2)), J * np.array([[1, 0.3], [0.2, 1], [0.5, 0.1]])])
        model = InputStateModel(expm(FREE * STEP), B, G, feed, STEP)
        found = find_unobservable(*augment(model, np.eye(2)))
        made = make_augmented(model, 1e-3 * np.eye(6), np.eye(2), 1e-2 * np.eye(len(G)), np.eye(8))
        staying = np.sum(np.abs(np.linalg.eigvals(made.F)) > 1.0 - 1e-4)
        assert staying == 8 - found.rank
