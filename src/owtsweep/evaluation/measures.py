"""Measures computed from errors: MSE, NEES and NIS of quantities of any dimension.

A linear estimator's error is the sum of two parts: one is due to the motion, the other to all else
(noise). Every measure here is a mean of squares, so it splits into three products of the parts:
motion x motion, motion x noise and noise x noise. With their means, here called motion, cross and
noise, the measure at any amplitude N of the motion is N^2 motion + 2 N cross + noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Quantity


class Errors(NamedTuple):
    """The errors of an estimator over a record.

    Attributes
    ----------
    state
        Errors of all judged quantities, shape (steps, n) each: either one array, the total error,
        or two arrays, the parts due to motion and to noise.
    covariance
        The estimator's covariances, shape (steps, n, n), NaN at steps without one. None if the
        estimator gave no covariance at all.
    innovation
        Innovations, shape (steps, m) each, NaN at steps without one: as many arrays as in `state`,
        or no array if the estimator gave no innovation.
    innovation_covariance
        Covariances of the innovations, shape (steps, m, m), or None.
    """

    state: Sequence[Array]
    covariance: Array | None = None
    innovation: Sequence[Array] = ()
    innovation_covariance: Array | None = None


class Mean(NamedTuple):
    """The mean of a measure over the steps of a record.

    `products`, shape (3,), are the means of motion x motion, motion x noise and noise x noise:
    products of the two parts of the error, one due to motion and one due to noise. If errors are
    not split into parts, they count as noise. `samples` is the number of steps in the means.
    """

    products: Array
    samples: int


def measure(errors: Errors, judged: Sequence[Quantity], first: int = 0) -> dict[str, Mean]:
    """Compute the measures of a record from step `first` on; return them by name.

    Measures are the mean squared error of every component and of every quantity (the sum over its
    components), NEES if the estimator gave covariances, and NIS if it gave innovations. NEES is the
    squared error weighted with the inverse of the estimator's covariance. NIS is the squared
    innovation weighted with the inverse of the innovation's covariance (Bar-Shalom, Li and
    Kirubarajan 2001, section 5.4).

    Parameters
    ----------
    judged
        The quantities, in the order of their components in the errors.
    """
    state = [part[first:] for part in errors.state]
    components = [name for quantity in judged for name in quantity.components]
    means = {
        name: Mean(_products([part[:, i] for part in state]), len(state[0]))
        for i, name in enumerate(components)
    }
    for quantity in judged:
        total, *rest = (means[name].products for name in quantity.components)
        means[quantity.name] = Mean(sum(rest, total), len(state[0]))
    if errors.covariance is not None:
        _add_weighted(means, "nees", state, errors.covariance[first:])
    if errors.innovation and errors.innovation_covariance is not None:
        innovation = [part[first:] for part in errors.innovation]
        _add_weighted(means, "nis", innovation, errors.innovation_covariance[first:])
    return means


def _add_weighted(
    means: dict[str, Mean], name: str, parts: Sequence[Array], covariance: Array
) -> None:
    """Add to `means`, under `name`, a mean square weighted with the inverse of a covariance.

    The mean is over the steps that have values and a covariance; without such steps, add nothing.
    """
    there = np.isfinite(covariance).all(axis=(1, 2)) & np.isfinite(parts[-1][:, 0])
    if there.any():  # after the settling time there may be no measurement
        weights = np.linalg.inv(covariance[there])
        products = _products([part[there] for part in parts], weights)
        means[name] = Mean(products, int(there.sum()))


def _products(parts: Sequence[Array], weights: Array | None = None) -> Array:
    """Compute the means of motion x motion, motion x noise and noise x noise, shape (3,).

    `parts` are the two parts of an error, or one array, which counts as noise.
    """

    def mean(a: Array, b: Array) -> float:
        if weights is None:
            return float(np.mean(a * b))
        return float(np.mean(np.einsum("ki,kij,kj->k", a, weights, b)))

    if len(parts) == 1:
        return np.array([0.0, 0.0, mean(parts[0], parts[0])])
    motion, noise = parts
    return np.array([mean(motion, motion), mean(motion, noise), mean(noise, noise)])
