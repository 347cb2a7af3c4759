"""Compute measures from errors of position and velocity in the plane: MSE, NEES and NIS.

A linear estimator's error is the sum of two parts: one part is due to the motion, the other to
everything else, called noise. Every measure here is a mean of squares, so it consists of the means
of three products: motion x motion, motion x noise and noise x noise. These means are called motion,
cross and noise. If the motion is multiplied by N, the measure is N^2 motion + 2 N cross + noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.trajectory import Trajectory


class Mean(NamedTuple):
    """The mean of a measure over `samples` steps of a record.

    `products`, shape (3,), are the means of motion x motion, motion x noise and noise x noise. An
    error that is not divided into parts counts as noise.
    """

    products: Array
    samples: int


def measure(errors: Sequence[Trajectory], first: int = 0) -> dict[str, Mean]:
    """Compute the measures of a record from step `first` on: mean squared errors, NEES and NIS.

    `errors` is the whole error of an estimator, or two parts, that due to the motion and that due
    to noise: trajectories whose `state` is an error. Covariances are those of the last part.

    There is a mean squared error of every component, and of position and velocity as the sum over
    both components. "nees" is the mean of the squared error weighted with the inverse of the
    estimator's covariance. "nis" is the mean of the squared innovation weighted with the inverse of
    the innovation's covariance (Bar-Shalom, Li and Kirubarajan 2001, section 5.4). Without a
    covariance from step `first` on, "nees" is left out; without an innovation, "nis" is.

    Return name of a component, "position", "velocity", "nees" or "nis" -> mean of the measure.
    """
    state, last = [part.state[first:] for part in errors], errors[-1]
    means = {
        name: Mean(_products([part[:, i] for part in state]), len(state[0]))
        for i, name in enumerate(("x", "y", "vx", "vy"))
    }
    for name, x, y in (("position", "x", "y"), ("velocity", "vx", "vy")):
        means[name] = Mean(means[x].products + means[y].products, len(state[0]))
    if last.covariance is not None:
        _add_weighted(means, "nees", state, last.covariance[first:])
    innovations = [part.innovation[first:] for part in errors if part.innovation is not None]
    if innovations and last.innovation_covariance is not None:
        _add_weighted(means, "nis", innovations, last.innovation_covariance[first:])
    return means


def _add_weighted(
    means: dict[str, Mean], name: str, parts: Sequence[Array], covariance: Array
) -> None:
    """Add to `means` a mean square weighted with the inverse of a covariance (steps, n, n).

    `parts` are the whole error or two parts of it, (steps, n) each. The mean is over the steps at
    which all is finite; if there is none, nothing is added.
    """
    there = np.isfinite(covariance).all(axis=(1, 2)) & np.isfinite(parts[-1][:, 0])
    if there.any():  # after the settling time there may be no measurement
        rows = _decorrelate(covariance[there], [part[there] for part in parts])
        products = sum((_products(errors, variance) for errors, variance in rows), np.zeros(3))
        means[name] = Mean(products, int(there.sum()))


def _decorrelate(covariance: Array, parts: Sequence[Array]) -> list[tuple[list[Array], Array]]:
    """Return components of the errors that do not correlate, each with its variance (steps,).

    By C = L D L' (Golub and Van Loan 2013, section 4.1), written out over the steps, as n is small:
    a' C^-1 b is the sum of (L^-1 a)_i (L^-1 b)_i / D_i. A part has the shape (steps, n), and
    `covariance` (steps, n, n).

    Raise `LinAlgError` if a covariance is singular.
    """
    n = covariance.shape[1]
    rest = np.ascontiguousarray(np.moveaxis(covariance, 0, -1))
    rows = [[part[:, i] for part in parts] for i in range(n)]
    for j in range(n):
        if not rest[j, j].all():
            raise np.linalg.LinAlgError("Singular matrix")
        for i in range(j + 1, n):
            factor = rest[i, j] / rest[j, j]
            rest[i, j + 1 :] -= factor * rest[j, j + 1 :]
            rows[i] = [low - factor * high for low, high in zip(rows[i], rows[j], strict=True)]
    return [(rows[i], rest[i, i]) for i in range(n)]


def _products(parts: Sequence[Array], variance: Array | None = None) -> Array:
    """Compute the means of motion x motion, motion x noise and noise x noise, shape (3,).

    The parts have the shape (steps,). With `variance`, (steps,), each product is divided by it.
    """

    def mean(a: Array, b: Array) -> float:
        return float(np.mean(a * b if variance is None else a * b / variance))

    if len(parts) == 1:
        return np.array([0.0, 0.0, mean(parts[0], parts[0])])
    motion, noise = parts
    return np.array([mean(motion, motion), mean(motion, noise), mean(noise, noise)])


def compute_rms_length(errors: Array) -> float:
    """Compute the root of the mean over samples of squared lengths, of errors (n, d)."""
    return float(np.sqrt(np.mean(np.sum(errors**2, axis=1))))


def average_nees(errors: Array, covariances: Array) -> float:
    """Compute the mean of e' P^-1 e over the dimension, of errors (n, d) and P (n, d, d)."""
    solved = np.linalg.solve(covariances, errors[:, :, None])[:, :, 0]
    return float(np.mean(errors * solved))
