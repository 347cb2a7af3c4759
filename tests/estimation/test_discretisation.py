"""Eq. (10): the exact integrals by quadrature, the printed sums by hand."""

from __future__ import annotations

import numpy as np
from scipy.integrate import quad_vec
from scipy.linalg import expm

from owtsweep.estimation.discretisation import Model, discretise

STEP = 0.3


def any_model() -> Model:
    random = np.random.default_rng(0)
    half = random.normal(size=(3, 3))
    return Model(A=random.normal(size=(3, 3)), B=random.normal(size=(3, 2)), Q=half @ half.T)


def test_exact_is_the_integral() -> None:
    model = any_model()
    discrete = discretise(model, STEP)

    def noise(s: float) -> np.ndarray:
        return expm(model.A * s) @ model.Q @ expm(model.A * s).T

    np.testing.assert_allclose(discrete.A, expm(model.A * STEP), rtol=1e-12)
    np.testing.assert_allclose(
        discrete.B, quad_vec(lambda s: expm(model.A * s) @ model.B, 0.0, STEP)[0], rtol=1e-10
    )
    np.testing.assert_allclose(discrete.Q, quad_vec(noise, 0.0, STEP)[0], rtol=1e-10)
    assert discrete.step == STEP


def test_first_order_is_the_print_made_symmetric() -> None:
    model = any_model()
    A, B, Q = model.A, model.B, model.Q
    discrete = discretise(model, STEP, "first_order")
    np.testing.assert_allclose(discrete.A, np.eye(3) + A * STEP)
    np.testing.assert_allclose(discrete.B, STEP * B + STEP**2 / 2 * A @ B)
    expected = Q * STEP + (Q @ A + A.T @ Q) / 2 * STEP**2 + A @ Q @ A.T * STEP**3 / 3
    np.testing.assert_allclose(discrete.Q, expected)


def test_a_first_order_hold_is_the_integral_over_a_linear_input() -> None:
    model = any_model()
    discrete = discretise(model, STEP, hold="first")
    assert discrete.B_next is not None
    begin, end = np.random.default_rng(1).normal(size=(2, 2))

    def driven(t: float) -> np.ndarray:
        return expm(model.A * (STEP - t)) @ model.B @ (begin + (end - begin) * t / STEP)

    found = discrete.B @ begin + discrete.B_next @ end
    np.testing.assert_allclose(found, quad_vec(driven, 0.0, STEP)[0], rtol=1e-10)


def test_the_prints_order_is_kept_under_a_linear_input() -> None:
    # T B + T^2/2 A B, shared out: an input of t / T gives T/2 B + T^2/6 A B
    model = any_model()
    A, B = model.A, model.B
    discrete = discretise(model, STEP, "first_order", hold="first")
    np.testing.assert_allclose(discrete.B_next, STEP / 2 * B + STEP**2 / 6 * A @ B)
    np.testing.assert_allclose(discrete.B, STEP / 2 * B + STEP**2 / 3 * A @ B)
