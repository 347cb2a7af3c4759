"""Measures computed from errors: MSE, NEES and NIS of quantities of any dimension.

A linear estimator's error is the sum of two parts, one from the motion and one from everything else
(noise). Every measure here is a mean of squares, so it splits into three products of the parts.
Their means give the measure at any amplitude N of the motion: N^2 motion + 2 N cross + noise.
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
        (steps, n) errors of all judged quantities: either one array of the total error, or two
        arrays of its parts, motion and noise.
    covariance
        (steps, n, n): the estimator's covariance, NaN at steps without one; None if it gave none.
    innovation
        (steps, m) innovations, as many arrays as in `state`, NaN at steps without one; or none.
    innovation_covariance
        (steps, m, m), or None.
    """

    state: Sequence[Array]
    covariance: Array | None = None
    innovation: Sequence[Array] = ()
    innovation_covariance: Array | None = None


class Mean(NamedTuple):
    """The mean of a measure over the steps of a record.

    products (3,): means of motion x motion, motion x noise, noise x noise; samples: number of steps
    in the means. If errors are not split into parts, they count as noise.
    """

    products: Array
    samples: int


def measure(errors: Errors, judged: Sequence[Quantity], first: int = 0) -> dict[str, Mean]:
    """Compute the measures of a record from step `first` on, by name.

    They are the mean squared error of every component, that of every quantity as the sum over its
    components, and NEES and NIS if the estimator gave covariances and innovations. NEES is the
    squared error weighted with the inverse of its covariance, NIS the same for the innovation
    (Bar-Shalom, Li and Kirubarajan 2001, section 5.4).

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
    """Add the mean square weighted with the inverse covariance, over the steps that have both."""
    there = np.isfinite(covariance).all(axis=(1, 2)) & np.isfinite(parts[-1][:, 0])
    if there.any():  # after the settling time there may be no measurement
        weights = np.linalg.inv(covariance[there])
        products = _products([part[there] for part in parts], weights)
        means[name] = Mean(products, int(there.sum()))


def _products(parts: Sequence[Array], weights: Array | None = None) -> Array:
    """Means of motion x motion, motion x noise, noise x noise; (3,)."""

    def mean(a: Array, b: Array) -> float:
        if weights is None:
            return float(np.mean(a * b))
        return float(np.mean(np.einsum("ki,kij,kj->k", a, weights, b)))

    if len(parts) == 1:
        return np.array([0.0, 0.0, mean(parts[0], parts[0])])
    motion, noise = parts
    return np.array([mean(motion, motion), mean(motion, noise), mean(noise, noise)])
