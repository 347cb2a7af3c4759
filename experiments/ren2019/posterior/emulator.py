"""A Gaussian process that interpolates the logarithms of a scheme's components between its points.

Rasmussen and Williams (2006), Gaussian Processes for Machine Learning: Eqs. (2.23) and (2.24) the
prediction, (2.43) the marginal likelihood, (5.12) the prediction of a point left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import cast

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import minimize

from owtsweep.arrays import Array

#: Largest mean square, as a multiple of the median over the design, that is interpolated: far above
#: it the logarithm rises so steeply that it would spoil the surface where the print can lie.
WORST = 30.0
#: Bounds of the logarithms of lengths (of a unit cube) and of the nugget.
_LENGTHS, _NUGGET = (np.log(0.1), np.log(20.0)), (np.log(1e-6), np.log(1e-1))


@dataclass(frozen=True)
class Emulator:
    """Predicts outputs at points of the unit cube.

    points: shape (points, settings), those of the design that count.
    lengths: of the kernel, shape (settings,).
    weights: shape (points, outputs); trend: shape (terms, outputs), of a quadratic.
    error: standard deviation of a point left out, shape (outputs,).
    """

    points: Array
    lengths: Array
    weights: Array
    trend: Array
    error: Array

    def predict(self, point: Array) -> Array:
        """Return the outputs at one point, shape (settings,), as an array (outputs,)."""
        nearness = _kernel(point[None], self.points, self.lengths)[0]
        return np.asarray(nearness @ self.weights + _terms(point[None])[0] @ self.trend)


def fit(points: Array, outputs: Array, hyper: Array | None = None) -> tuple[Emulator, Array]:
    """Fit an emulator to outputs (points, outputs); return it with its hyperparameters.

    hyper: logarithms of the kernel's lengths and nugget; None searches those of the greatest
        marginal likelihood, summed over the outputs, whose variances are profiled out.
    Points with an output that is not finite, or too large (`WORST`), are left out.
    """
    good = np.isfinite(outputs).all(axis=1)
    limit = np.median(outputs[good], axis=0) + np.log(WORST)
    good &= (outputs < limit).all(axis=1)
    points, outputs = points[good], outputs[good]
    if hyper is None:
        start = np.append(np.full(points.shape[1], np.log(1.0)), np.log(1e-3))
        bounds = [_LENGTHS] * points.shape[1] + [_NUGGET]
        some = slice(256)  # enough for nine numbers, and Sobol's first points fill the cube
        found = minimize(_cost, start, (points[some], outputs[some]), bounds=bounds)
        hyper = cast("Array", found.x)
    factor, terms = _factorise(points, hyper), _terms(points)
    trend, weights, inverse = _solve(factor, terms, outputs)
    # (5.12), with the trend held
    left_out = weights / np.diag(inverse)[:, None]
    error = np.sqrt(np.mean(left_out**2, axis=0))
    return Emulator(points, np.exp(hyper[:-1]), weights, trend, error), hyper


def _kernel(one: Array, other: Array, lengths: Array) -> Array:
    """Matern's kernel of order 5/2, (4.17) of the book."""
    gap = (one[:, None, :] - other[None, :, :]) / lengths
    distance = np.sqrt(5.0 * np.einsum("ijk,ijk->ij", gap, gap))
    return np.asarray((1.0 + distance + distance**2 / 3.0) * np.exp(-distance))


@cache
def _pairs(count: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    return np.triu_indices(count)


def _terms(points: Array) -> Array:
    """The terms of a quadratic, shape (points, terms)."""
    first, second = _pairs(points.shape[1])
    ones = np.ones((len(points), 1))
    return np.hstack([ones, points, points[:, first] * points[:, second]])


def _factorise(points: Array, hyper: Array) -> tuple[Array, bool]:
    matrix = _kernel(points, points, np.exp(hyper[:-1]))
    matrix[np.diag_indices_from(matrix)] += np.exp(hyper[-1])
    return cast("tuple[Array, bool]", cho_factor(matrix, lower=True))


def _solve(factor: tuple[Array, bool], terms: Array, outputs: Array) -> tuple[Array, Array, Array]:
    """Return the trend by generalised least squares, the weights, and the kernel's inverse."""
    inverse = cho_solve(factor, np.eye(len(terms)))
    trend = np.linalg.solve(terms.T @ inverse @ terms, terms.T @ inverse @ outputs)
    return trend, np.asarray(inverse @ (outputs - terms @ trend)), np.asarray(inverse)


def _cost(hyper: Array, points: Array, outputs: Array) -> float:
    """Minus the logarithm of the marginal likelihood, (2.43), without constants."""
    factor, terms = _factorise(points, hyper), _terms(points)
    trend, weights, _ = _solve(factor, terms, outputs)
    scatter = np.sum((outputs - terms @ trend) * weights, axis=0) / len(points)
    logdet = 2.0 * np.log(np.diag(factor[0])).sum()
    return float(0.5 * (len(points) * np.log(scatter).sum() + outputs.shape[1] * logdet))
