"""The predictor is exact without noise, and its noise model is the response to its inputs."""

from __future__ import annotations

import numpy as np

from owtsweep.estimation.discretisation import Model, discretise, powers, predict, prediction_noise

STEP = 0.01
#: Sigma_2 on one axis: position, velocity, b = x4; input u = R f.
MODEL = Model(
    A=np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]),
    B=np.array([[0.0], [1.0], [0.0]]),
    Q=np.diag([0.0, 0.2, 0.03]),
)


def test_exact_for_constant_acceleration_with_bias() -> None:
    p, v, acceleration, bias = 0.7, -1.3, 0.9, 0.05
    steps = 40
    force = np.full((steps, 1), acceleration + bias)  # the sensor adds its bias; x4 = -bias
    x = predict(discretise(MODEL, STEP), np.array([p, v, -bias]), force)
    t = steps * STEP
    expected = [p + v * t + acceleration * t**2 / 2, v + acceleration * t, -bias]
    np.testing.assert_allclose(x, expected, rtol=1e-13)


def test_inputs_count_in_the_order_of_time() -> None:
    discrete = discretise(MODEL, STEP)
    early = predict(discrete, np.zeros(3), np.array([[1.0], [0.0], [0.0]]))
    late = predict(discrete, np.zeros(3), np.array([[0.0], [0.0], [1.0]]))
    np.testing.assert_allclose(early[:2], [STEP**2 / 2 + 2 * STEP * STEP, STEP])
    np.testing.assert_allclose(late[:2], [STEP**2 / 2, STEP])


def test_noise_is_the_response_to_each_input_and_each_step() -> None:
    discrete = discretise(MODEL, STEP)
    steps = 7
    noise = prediction_noise(discrete, steps)
    for i in range(steps):
        unit = np.zeros((steps, 1))
        unit[i] = 1.0
        np.testing.assert_allclose(noise.response[i], predict(discrete, np.zeros(3), unit))
    state = np.array([0.3, 0.2, 0.1])
    np.testing.assert_allclose(
        noise.transition @ state, predict(discrete, state, np.zeros((steps, 1)))
    )
    P = np.zeros((3, 3))
    for _ in range(steps):
        P = discrete.A @ P @ discrete.A.T + discrete.Q
    np.testing.assert_allclose(noise.process, P)


def test_powers() -> None:
    A = np.array([[0.5, 1.0], [0.1, 0.2]])
    for i, power in enumerate(powers(A, 4)):
        np.testing.assert_allclose(power, np.linalg.matrix_power(A, i))


def test_a_first_order_hold_is_exact_for_a_linear_force() -> None:
    steps, jerk = 30, 1.7
    t = STEP * np.arange(steps + 1)
    x = predict(discretise(MODEL, STEP, hold="first"), np.zeros(3), jerk * t[:, None])
    end = t[-1]
    np.testing.assert_allclose(x, [jerk * end**3 / 6, jerk * end**2 / 2, 0.0], rtol=1e-12)


def test_with_a_first_order_hold_noise_is_the_response_to_one_more_input() -> None:
    discrete = discretise(MODEL, STEP, hold="first")
    for steps in (0, 1, 7):
        noise = prediction_noise(discrete, steps)
        assert noise.response.shape == (steps + 1, 3)
        for i in range(steps + 1):
            unit = np.zeros((steps + 1, 1))
            unit[i] = 1.0
            np.testing.assert_allclose(noise.response[i], predict(discrete, np.zeros(3), unit))
