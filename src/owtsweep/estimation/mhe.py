"""Moving horizon estimation, Eq. (11) of Ren et al. (2019).

The estimator fits the states at the times of several position fixes (of GNSS), a window, to these
fixes and to the inputs, which are integrated from each fix to the next. Eq. (11) is read as follows
(PAPER.md, section 4; REPRODUCTION.md, row "Eq. (11)"). Norms are squared. The nodes of the window
are the times of its fixes, and a last node at the present delayed time, t_f after the last fix.
A link joins two neighbouring nodes, and every link is weighted once.

Without constraints the last link is met exactly, because the last node has no measurement. The
estimate is then the least-squares state at the last fix, predicted over t_f by the inputs. The
least-squares state is a linear function of fixes, inputs and arrival state (the state assumed at
the oldest node), with constant coefficients. `window_maps` computes the matrix of coefficients.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array


@dataclass(frozen=True)
class WindowWeights:
    """The weights of one axis in the cost of Eq. (11a) of Ren et al. (2019).

    transition: transition matrix (states, states) from one position fix to the next.
    link_covariance: covariance (states, states) of the process noise from one fix to the next; the
        inverse of the paper's weight Q.
    fix_variance: variance of a fix, in m^2; the inverse of the paper's weight R. A fix measures the
        first state.
    """

    transition: Array
    link_covariance: Array
    fix_variance: float


def square_root_information(covariance: Array) -> Array:
    """Compute a lower triangular matrix U (n, n) with U' U = covariance^-1.

    Raises numpy.linalg.LinAlgError if `covariance` is not positive definite.
    """
    lower = np.linalg.cholesky(covariance)
    return np.linalg.solve(lower, np.eye(len(covariance)))


def window_maps(
    weights: WindowWeights,
    intervals: int,
    arrival_covariances: Iterable[Array | None],
    *,
    fixed_arrival: bool = False,
    use_first_fix: bool = True,
) -> Iterator[Array]:
    """Yield the matrices that turn the data of windows into the states at their last fixes.

    A state solves Eq. (11) of Ren et al. (2019) without constraints, for one axis of the motion. A
    matrix has the shape (states, intervals + 1 + states * intervals + states). Its columns belong
    to the fixes, oldest first, then to the effects of the inputs on the state over each interval,
    then to the arrival state. The columns of data that is not used are zero. The windows differ in
    their arrival covariance alone, so the equations of fixes and links are set up once for all of
    them, which saves a third of the time.

    intervals: number of fixes minus one.
    arrival_covariances: covariance (states, states) of the arrival state of each window; None if
        the cost has no term for it.
    fixed_arrival: whether the state at the oldest fix must equal the arrival state.
    use_first_fix: false if the arrival state already includes the oldest fix.
    Raises ValueError if the data of a window do not determine the window's states.
    """
    n = len(weights.transition)
    nodes = intervals + 1
    information = square_root_information(weights.link_covariance)
    rows = nodes + n * intervals + n
    J = np.zeros((rows, n * nodes))
    D = np.zeros((rows, nodes + n * intervals + n))
    sigma = np.sqrt(weights.fix_variance)
    for i in range(0 if use_first_fix else 1, nodes):
        J[i, n * i] = 1.0 / sigma
        D[i, i] = 1.0 / sigma
    for i in range(intervals):
        at = slice(nodes + n * i, nodes + n * (i + 1))
        J[at, n * i : n * (i + 1)] = -information @ weights.transition
        J[at, n * (i + 1) : n * (i + 2)] = information
        D[at, at] = information
    at = slice(rows - n, rows)
    for covariance in arrival_covariances:
        prior = np.zeros((n, n)) if covariance is None else square_root_information(covariance)
        J[at, :n] = prior
        D[at, at] = prior
        if not fixed_arrival:
            yield _solve_for_last(J, D, n)
        elif intervals == 0:
            yield np.hstack([np.zeros((n, 1)), np.eye(n)])
        else:
            D[:, at] = -J[:, :n]
            yield _solve_for_last(J[:, n:], D, n)


def _solve_for_last(J: Array, D: Array, n: int) -> Array:
    """Return the matrix from data d to the last n of the unknowns x that minimise |J x - D d|.

    Raises ValueError if the data do not determine the unknowns.
    """
    scale = np.linalg.norm(J, axis=0)
    if np.any(scale == 0.0):
        raise ValueError("the window's data do not determine its states")
    q, r = np.linalg.qr(J / scale)
    if np.min(np.abs(np.diagonal(r))) < 1e-12:
        raise ValueError("the window's data do not determine its states")
    solution = np.linalg.solve(r[-n:, -n:], q[:, -n:].T @ D)  # r is triangular: the last block
    return np.asarray(solution / scale[-n:, None])
