"""Predict a state by the model and stored inputs alone, Algorithm 9 of Ren et al. (2019)."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

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
        The inputs of the steps, shape (steps, inputs), oldest first. If the model's inputs are
        linear over a step (`model.B_next`), there is one more row: the input at the end of the last
        step.
    """
    if model.B_next is None:
        for u in inputs:
            state = model.A @ state + model.B @ u
        return state
    for u, after in pairwise(inputs):
        state = model.A @ state + model.B @ u + model.B_next @ after
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

    A, B and B_next are the matrices of the model x[k+1] = A x[k] + B u[k] + B_next u[k+1] + w[k].

    Attributes
    ----------
    transition
        A^steps, shape (states, states): the effect of an error in the first state.
    response
        Row i is the effect of an error in input i, shape (steps, states). Without B_next, row i is
        A^(steps-1-i) B. With B_next there is one more row: input i acts at the beginning of step i
        and at the end of the step before.
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
    response = response.reshape(steps, len(model.A))
    if model.B_next is not None:
        at_end = np.array([A[steps - 1 - i] @ model.B_next[:, 0] for i in range(steps)])
        response = np.pad(response, [(0, 1), (0, 0)])
        response[1:] += at_end.reshape(steps, len(model.A))
    process = np.zeros_like(model.Q)
    for i in range(steps):
        process += A[i] @ model.Q @ A[i].T
    return PredictionNoise(A[steps], response, process)
