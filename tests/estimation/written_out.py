"""Brute force for input-state estimators: the joint Gaussian of a record, written out.

Everything random in a record is one long vector: the first state, process noise, inputs, and
the sensors' noise. States and measurements are linear in it, by writing the model out. One
conditioning gives any state and input from any measurements; nothing is recursive in what is
measured.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.estimation.input_state import InputStateModel

Array = NDArray[np.float64]


class Case(NamedTuple):
    """A model, covariances and a record.

    Q (n, n), S (p, p) and R (m, m) are per step; P0 (n + p, n + p) stands one step before the first
    measurement. states (steps, n), inputs (steps, p) and y (steps, m) are one draw.
    """

    model: InputStateModel
    Q: Array
    S: Array
    R: Array
    P0: Array
    states: Array
    inputs: Array
    y: Array


def draw_case(seed: int, n: int = 4, inputs: int = 2, m: int = 3, steps: int = 12) -> Case:
    """A random stable model with feedthrough, and a record under inputs that are random walks."""
    random = np.random.default_rng(seed)
    A = random.normal(size=(n, n))
    A *= 0.97 / np.abs(np.linalg.eigvals(A)).max()
    model = InputStateModel(
        A,
        random.normal(size=(n, inputs)),
        random.normal(size=(m, n)),
        random.normal(size=(m, inputs)),
        0.1,
    )
    Q, S, R, P0 = (
        half @ half.T + 0.01 * np.eye(len(half))
        for half in (random.normal(size=(k, k)) for k in (n, inputs, m, n + inputs))
    )
    p = random.normal(size=inputs) + np.cumsum(
        random.multivariate_normal(np.zeros(inputs), S, steps), axis=0
    )
    w = random.multivariate_normal(np.zeros(n), Q, steps)
    x = np.zeros((steps, n))
    for k in range(1, steps):
        x[k] = model.A @ x[k - 1] + model.B @ p[k - 1] + w[k]
    v = random.multivariate_normal(np.zeros(m), R, steps)
    return Case(model, Q, S, R, P0, x, p, x @ model.G.T + p @ model.J.T + v)


class WrittenOut:
    """The joint Gaussian of the states, inputs and measurements of some steps.

    `before` is the joint covariance of the state before the first step and of the inputs from this
    step on: (n + (steps + 1) p) squared.
    """

    def __init__(self, model: InputStateModel, Q: Array, R: Array, before: Array, steps: int):
        n, p = model.B.shape
        m = len(model.G)
        self.n, self.p, self.m = n, p, m
        size = len(before) + steps * n
        covariance = np.zeros((size, size))
        covariance[: len(before), : len(before)] = before
        covariance[len(before) :, len(before) :] = np.kron(np.eye(steps), Q)
        maps = np.zeros((steps, n + p, size))
        state = np.eye(n, size)
        for k in range(steps):
            old, new = n + k * p, n + (k + 1) * p
            state = model.A @ state
            state[:, old : old + p] += model.B
            state[:, len(before) + k * n :][:, :n] += np.eye(n)
            maps[k, :n] = state
            maps[k, n:, new : new + p] = np.eye(p)
        H = np.vstack([np.hstack([model.G, model.J]) @ at for at in maps])
        self.maps, self.covariance, self.H = maps, covariance, H
        self.S = H @ covariance @ H.T + np.kron(np.eye(steps), R)

    def estimate(self, y: Array, step: int, last: int) -> Array:
        """State and input of a step, given the measurements up to the step `last`."""
        rows = (last + 1) * self.m
        cross = self.maps[step] @ self.covariance @ self.H[:rows].T
        return cross @ np.linalg.solve(self.S[:rows, :rows], y[: last + 1].ravel())


def walk(P0: Array, S: Array, steps: int) -> Array:
    """Covariance of [x before, p before, p of step 0, 1, ...] for inputs that are random walks."""
    n, p = len(P0) - len(S), len(S)
    lift = np.zeros((n + (steps + 1) * p, n + p + steps * p))
    lift[:n, :n] = np.eye(n)
    for k in range(steps + 1):
        for j in range(k + 1):  # the first value, then the changes
            lift[n + k * p :, n + j * p :][:p, :p] = np.eye(p)
    noise = np.zeros((n + p + steps * p,) * 2)
    noise[: n + p, : n + p] = P0
    noise[n + p :, n + p :] = np.kron(np.eye(steps), S)
    return lift @ noise @ lift.T
