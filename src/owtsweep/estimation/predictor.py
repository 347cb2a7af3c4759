"""Predict a state by the model and stored inputs alone, Algorithm 9 of Ren et al. (2019)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.discretisation import Discrete


def predict(model: Discrete, state: Array, inputs: Array) -> Array:
    """Predict a state over some steps by the model and the inputs; return the state at the end.

    Algorithm 9 of Ren et al. (2019) prints N_d - 1 steps with the inputs of register 1, then N_s
    steps with u_s, which is the wrong order in time. Here the inputs are in order of time.

    Parameters
    ----------
    model
        The model in discrete time.
    state
        The state before the first step, shape (states,).
    inputs
        The inputs of the steps, shape (steps, inputs), oldest first.
    """
    for u in inputs:
        state = model.A @ state + model.B @ u
    return state


def powers(A: Array, count: int) -> Array:
    """Compute the powers I, A, A^2, ..., A^count of a matrix A (states, states).

    The result has the shape (count + 1, states, states).
    """
    result = np.empty((count + 1, *A.shape))
    result[0] = np.eye(len(A))
    for i in range(count):
        result[i + 1] = A @ result[i]
    return result


@dataclass(frozen=True)
class PredictionNoise:
    """The effects of noise on the predicted state, after a number of steps.

    A and B are the matrices of the model x[k+1] = A x[k] + B u[k] + w[k].

    Attributes
    ----------
    transition
        A^steps, shape (states, states): the effect of an error in the first state.
    response
        Shape (steps, states): row i is A^(steps-1-i) B, the effect of an error in the input of step
        i.
    process
        Covariance of the predicted state due to the noise w of all steps, shape (states, states).
    """

    transition: Array
    response: Array
    process: Array


def prediction_noise(model: Discrete, steps: int) -> PredictionNoise:
    """Compute the effects of noise on a prediction over `steps` steps, for a model with one input.

    The noise is an error in the first state, errors in the inputs, and the process noise.
    """
    A = powers(model.A, steps)
    response = np.array([A[steps - 1 - i] @ model.B[:, 0] for i in range(steps)])
    process = np.zeros_like(model.Q)
    for i in range(steps):
        process += A[i] @ model.Q @ A[i].T
    return PredictionNoise(A[steps], response.reshape(steps, len(model.A)), process)
