"""Predicts a state by the model and stored inputs alone, Algorithm 9 of Ren et al. (2019)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.discretisation import Discrete


def predict(model: Discrete, state: Array, inputs: Array) -> Array:
    """Predict a state (states,) over the steps of `inputs` (steps, inputs), oldest first.

    Algorithm 9 of Ren et al. (2019) prints N_d - 1 steps with the inputs of register 1, then N_s
    steps with u_s, which is the wrong order in time. Here the inputs are in order of time.
    """
    for u in inputs:
        state = model.A @ state + model.B @ u
    return state


def powers(A: Array, count: int) -> Array:
    """Compute the powers I, A, A^2, ..., A^count, shape (count + 1, states, states)."""
    result = np.empty((count + 1, *A.shape))
    result[0] = np.eye(len(A))
    for i in range(count):
        result[i + 1] = A @ result[i]
    return result


@dataclass(frozen=True)
class PredictionNoise:
    """The ways in which noise enters a prediction over some number of steps.

    Attributes
    ----------
    transition
        Shape (states, states): A^steps.
    response
        Shape (steps, states): row i is A^(steps-1-i) B, the effect of the input's noise at step i.
    process
        Shape (states, states): covariance of the process noise that all steps add.
    """

    transition: Array
    response: Array
    process: Array


def prediction_noise(model: Discrete, steps: int) -> PredictionNoise:
    """Compute how noise enters a prediction over `steps` steps, for a model with one input."""
    A = powers(model.A, steps)
    response = np.array([A[steps - 1 - i] @ model.B[:, 0] for i in range(steps)])
    process = np.zeros_like(model.Q)
    for i in range(steps):
        process += A[i] @ model.Q @ A[i].T
    return PredictionNoise(A[steps], response.reshape(steps, len(model.A)), process)
