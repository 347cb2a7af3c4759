"""The oracle of the estimation tests: least squares over all states of a record at once.

Nothing here is recursive: the prior, every process step and every measurement are rows of one
whitened system, which numpy solves.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.estimation.discretisation import Discrete

Array = NDArray[np.float64]


class Measurement(NamedTuple):
    """value = row x_step + noise of that variance; the prior stands at step -1."""

    step: int
    row: Array
    value: float
    variance: float


class Posterior(NamedTuple):
    """mean (steps + 1, states), covariance (steps + 1, states, steps + 1, states).

    Index 0 is the prior's state, index k + 1 the state of step k. error (steps + 1, states, noises)
    is how unit noises make the error of the mean: those of the prior and of the steps, then one per
    measurement, in their order.
    """

    mean: Array
    covariance: Array
    error: Array


def posterior(
    model: Discrete,
    prior: Array,
    inputs: Array,
    measurements: Sequence[Measurement],
) -> Posterior:
    """All states of steps -1 ... len(inputs) - 1 given the measurements.

    Parameters
    ----------
    prior
        (states, states) covariance of the state at step -1, whose mean is zero.
    inputs
        (steps, inputs): inputs[k] acts between the steps k - 1 and k.
    """
    n, steps = len(prior), len(inputs)
    size = n * (steps + 1)
    blocks, values = [np.zeros((n, size))], [np.zeros(n)]
    blocks[0][:, :n] = whitener(prior)
    half = whitener(model.Q)
    for k in range(steps):
        block = np.zeros((n, size))
        block[:, n * k : n * (k + 1)] = -half @ model.A
        block[:, n * (k + 1) : n * (k + 2)] = half
        blocks.append(block)
        values.append(half @ model.B @ inputs[k])
    for step, row, value, variance in measurements:
        block = np.zeros((1, size))
        block[0, n * (step + 1) : n * (step + 2)] = row / np.sqrt(variance)
        blocks.append(block)
        values.append(np.array([value / np.sqrt(variance)]))
    J, y = np.vstack(blocks), np.concatenate(values)
    scale = np.linalg.norm(J, axis=0)
    q, r = np.linalg.qr(J / scale)
    root = np.linalg.solve(r, np.eye(size)) / scale[:, None]
    gain = root @ q.T
    mean = gain @ y
    covariance = (root @ root.T).reshape(steps + 1, n, steps + 1, n)
    return Posterior(mean.reshape(steps + 1, n), covariance, gain.reshape(steps + 1, n, len(y)))


def whitener(covariance: Array) -> Array:
    """U with U' U = covariance^-1, by eigenvalues."""
    deviation = np.sqrt(np.diagonal(covariance))
    values, vectors = np.linalg.eigh(covariance / np.outer(deviation, deviation))
    return np.asarray((vectors / np.sqrt(values)).T / deviation)
