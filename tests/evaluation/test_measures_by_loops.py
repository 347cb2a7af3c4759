"""MSE, NEES and NIS, against plain loops."""

from __future__ import annotations

import numpy as np
import pytest

from owtsweep.evaluation.measures import measure
from owtsweep.evaluation.trajectory import Trajectory

STEPS, FIRST = 30, 10


def draw(seed: int, *, sparse: bool = True) -> Trajectory:
    random = np.random.default_rng(seed)
    half, S = random.normal(size=(STEPS, 4, 4)), random.normal(size=(STEPS, 3, 3))
    covariance = half @ half.transpose(0, 2, 1) + np.eye(4)
    innovation, metric = random.normal(size=(STEPS, 3)), S @ S.transpose(0, 2, 1) + np.eye(3)
    if sparse:
        covariance[:2] = np.nan
        innovation[np.arange(STEPS) % 4 != 0] = np.nan
    return Trajectory(random.normal(size=(STEPS, 4)), covariance, innovation, metric)


@pytest.mark.parametrize("first", [0, FIRST])
def test_measures_are_means(first: int) -> None:
    errors = draw(0)
    means = measure([errors], first)
    assert list(means) == ["x", "y", "vx", "vy", "position", "velocity", "nees", "nis"]
    e, P = errors.state, errors.covariance
    v, S = errors.innovation, errors.innovation_covariance
    assert P is not None
    assert v is not None
    assert S is not None
    squares = np.mean(e[first:] ** 2, axis=0)
    nees = [e[k] @ np.linalg.solve(P[k], e[k]) for k in range(max(first, 2), STEPS)]
    nis = [v[k] @ np.linalg.solve(S[k], v[k]) for k in range(first, STEPS) if k % 4 == 0]
    for name, value, count in (
        ("x", squares[0], STEPS - first),
        ("vx", squares[2], STEPS - first),
        ("position", squares[:2].sum(), STEPS - first),
        ("velocity", squares[2:].sum(), STEPS - first),
        ("nees", np.mean(nees), len(nees)),
        ("nis", np.mean(nis), len(nis)),
    ):
        np.testing.assert_allclose(means[name].products, [0.0, 0.0, value], rtol=1e-12)
        assert means[name].samples == count


def test_a_covariance_that_says_no_error_is_refused() -> None:
    """Else its NEES would be stored as no number, of a case that is taken for good."""
    errors = draw(0)
    assert errors.covariance is not None
    covariance = errors.covariance.copy()
    covariance[STEPS - 1] = 0.0
    with pytest.raises(np.linalg.LinAlgError, match="Singular matrix"):
        measure([errors._replace(covariance=covariance)])


def test_products_superpose() -> None:
    motion, noise, N = draw(1, sparse=False), draw(2), 3.5
    whole = noise._replace(
        state=N * motion.state + noise.state, innovation=N * motion.innovation + noise.innovation
    )
    together = measure([whole], FIRST)
    for name, ((mm, mn, nn), samples) in measure([motion, noise], FIRST).items():
        assert N**2 * mm + 2 * N * mn + nn == pytest.approx(together[name].products[2], rel=1e-11)
        assert samples == together[name].samples


def test_without_covariance_and_innovation_there_is_no_consistency() -> None:
    bare = Trajectory(np.ones((STEPS, 4)))
    assert not {"nees", "nis"} & set(measure([bare]))


def test_without_a_measurement_in_the_window_there_is_no_nis() -> None:
    errors = draw(3)
    errors.innovation[FIRST:] = np.nan
    assert "nis" in measure([errors])
    assert "nis" not in measure([errors], FIRST)
