"""Open-loop prediction over a stored input sequence, Algorithm 9 of Ren et al. (2019)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.discretisation import Discrete


def predict(model: Discrete, state: Array, inputs: Array) -> Array:
    """Step `state` (states,) through `inputs` (steps, inputs), oldest first.

    The paper prints N_d - 1 steps with register 1, then N_s with u_s, which is the wrong order in
    time. Here the inputs are in order of time.
    """
    for u in inputs:
        state = model.A @ state + model.B @ u
    return state


def powers(A: Array, count: int) -> Array:
    """(count + 1, states, states): I, A, A^2, ..., A^count."""
    result = np.empty((count + 1, *A.shape))
    result[0] = np.eye(len(A))
    for i in range(count):
        result[i + 1] = A @ result[i]
    return result


@dataclass(frozen=True)
class PredictionNoise:
    """How the noise of the inputs enters a prediction over `steps` steps.

    Attributes
    ----------
    transition
        (states, states): A^steps.
    response
        (steps, states): A^(steps-1-i) B, the effect of the noise of input i.
    process
        (states, states): covariance of the process noise gathered on the way.
    """

    transition: Array
    response: Array
    process: Array


def prediction_noise(model: Discrete, steps: int) -> PredictionNoise:
    """Response of a single-input model to the noise of each input of a prediction."""
    A = powers(model.A, steps)
    response = np.array([A[steps - 1 - i] @ model.B[:, 0] for i in range(steps)])
    process = np.zeros_like(model.Q)
    for i in range(steps):
        process += A[i] @ model.Q @ A[i].T
    return PredictionNoise(A[steps], response.reshape(steps, len(model.A)), process)
