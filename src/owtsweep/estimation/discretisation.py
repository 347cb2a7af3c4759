"""Turn a model in continuous time into one in discrete time, and predict by it.

Eq. (10) and Algorithm 9 of Ren et al. (2019).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from owtsweep.arrays import Array


@dataclass(frozen=True)
class Model:
    """The model x' = A x + B u + w in continuous time, where w is white noise of intensity Q.

    A, B, Q: shapes (states, states), (states, inputs), (states, states); SI units, Q per second.
    """

    A: Array
    B: Array
    Q: Array


@dataclass(frozen=True)
class Discrete:
    """The model x[k+1] = A x[k] + B u[k] + B_next u[k+1] + w[k] in discrete time, of a `step` in s.

    A, Q: transition matrix and covariance of w[k], shape (states, states).
    B, B_next: shape (states, inputs). `B_next` belongs to an input that is linear from k to k + 1
        (a first-order hold); None if the input is constant (a zero-order hold).
    """

    A: Array
    B: Array
    Q: Array
    step: float
    B_next: Array | None = None


def discretise(model: Model, step: float, method: str = "exact", *, hold: str = "zero") -> Discrete:
    """Turn a model in continuous time into a discrete one.

    step: length T of a step, in s.
    method: "exact" computes the integrals of Eq. (10) of Ren et al. (2019). "first_order" computes
        the approximation printed with Eq. (10): A becomes I + A T (10c), B becomes T B + T^2/2 A B
        (10d), and Q becomes the symmetric part of Q T + Q A T^2 + A Q A' T^3/3 (10e).
    hold: "zero": the input is constant over a step, as in the paper. "first": the input is linear
        between the samples at both ends of a step (also called triangle hold).
    """
    from scipy.linalg import expm

    if hold == "first":
        return _hold_linearly(model, discretise(model, step, method), method)
    A, B, Q = model.A, model.B, model.Q
    n = len(A)
    if method == "first_order":
        printed = Q * step + Q @ A * step**2 + A @ Q @ A.T * step**3 / 3.0
        return Discrete(
            A=np.eye(n) + A * step,
            B=step * B + step**2 / 2.0 * A @ B,
            Q=0.5 * (printed + printed.T),
            step=step,
        )
    van_loan = expm(np.block([[-A, Q], [np.zeros((n, n)), A.T]]) * step)
    Ad = van_loan[n:, n:].T
    Qd = Ad @ van_loan[:n, n:]
    return Discrete(A=Ad, B=hold_input(A, B, step)[1], Q=0.5 * (Qd + Qd.T), step=step)


def hold_input(A: Array, B: Array, step: float) -> tuple[Array, Array]:
    """Return the matrices over a step, in s, of x' = A x + B u whose input is held (Van Loan 1978).

    The exponential of the block matrix [[A, B], [0, 0]] serves any A. Shapes are those of A and B.
    """
    from scipy.linalg import expm

    n, m = B.shape
    block = np.zeros((n + m, n + m))
    block[:n, :n], block[:n, n:] = A, B
    held = expm(block * step)
    return held[:n, :n], held[:n, n:]


def _hold_linearly(model: Model, held: Discrete, method: str) -> Discrete:
    """Make the input linear over a step in a discrete model in which it is constant, `held`.

    An input that rises from 0 to 1 over a step changes the state by B_next. An input that falls
    from 1 to 0 changes it by the rest of what a constant input of 1 does.
    """
    from scipy.linalg import expm

    A, B, step = model.A, model.B, held.step
    n, m = B.shape
    if method == "first_order":
        rising = step / 2.0 * B + step**2 / 6.0 * A @ B
    else:
        augmented = np.zeros((n + 2 * m, n + 2 * m))
        augmented[:n, :n], augmented[:n, n : n + m] = A, B
        augmented[n : n + m, n + m :] = np.eye(m) / step
        rising = expm(augmented * step)[:n, n + m :]
    return replace(held, B=held.B - rising, B_next=rising)


def predict(model: Discrete, state: Array, inputs: Array) -> Array:
    """Predict a state (states,) over some steps by the inputs; return the state at the end.

    Algorithm 9 of Ren et al. (2019) prints N_d - 1 steps with the inputs of register 1, then N_s
    steps with u_s, which is the wrong order in time. Here the inputs are in order of time.

    inputs: shape (steps, inputs), oldest first. If they are linear over a step (`model.B_next`),
        there is one more row: the input at the end of the last step.
    """
    if model.B_next is None:
        for u in inputs:
            state = model.A @ state + model.B @ u
        return state
    for u, after in pairwise(inputs):
        state = model.A @ state + model.B @ u + model.B_next @ after
    return state


def powers(A: Array, count: int) -> Array:
    """Compute I, A, A^2, ..., A^count of a matrix A (n, n); shape (count + 1, n, n)."""
    result = np.empty((count + 1, *A.shape))
    result[0] = np.eye(len(A))
    for i in range(count):
        result[i + 1] = A @ result[i]
    return result


@dataclass(frozen=True)
class PredictionNoise:
    """The effects of noise on the predicted state, after a number of steps of a `Discrete` model.

    transition: A^steps, shape (states, states): the effect of an error in the first state.
    response: row i is the effect of an error in input i, shape (steps, states). Without B_next, row
        i is A^(steps-1-i) B. With B_next there is one more row: input i acts at the beginning of
        step i and at the end of the step before.
    process: covariance of the predicted state due to the noise w of all steps, (states, states).
    """

    transition: Array
    response: Array
    process: Array


def prediction_noise(model: Discrete, steps: int) -> PredictionNoise:
    """Compute the effects of noise on a prediction over some steps, for a model with one input."""
    A = powers(model.A, steps)

    def respond(B: Array) -> Array:
        return np.array([P @ B[:, 0] for P in A[:steps][::-1]]).reshape(steps, len(B))

    response = respond(model.B)
    if model.B_next is not None:
        response = np.pad(response, [(0, 1), (0, 0)])
        response[1:] += respond(model.B_next)
    process = np.zeros_like(model.Q)
    for i in range(steps):
        process += A[i] @ model.Q @ A[i].T
    return PredictionNoise(A[steps], response, process)
