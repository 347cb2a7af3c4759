"""The augmented Kalman filter: unknown inputs join the state as random walks.

Lourens et al. (2012); Algorithm 1 and Eqs. (17) to (24) of Simpson et al. (2025). Their Algorithm 1
prints P^-_{k-1} in the prediction of the covariance, where P_{k-1} belongs.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import block_diag, solve_discrete_are

from owtsweep.arrays import Array
from owtsweep.estimation.input_state import Filter, InputStateModel, make_kalman
from owtsweep.estimation.lagged import Lagged, make_smoother
from owtsweep.estimation.square_root import check_noise

#: The steady gain is taken from the Riccati equation if the closed loop's radius is this far below
#: 1. Nearer to 1, the equation's solution is not accurate.
FADING = 1e-6


def augment(
    model: InputStateModel, transition: Array, read: Array | None = None
) -> tuple[Array, Array]:
    """Return transition matrix and measurement matrix of the state [x, z] (Eqs. 18 to 22).

    transition: of z, which makes the inputs, shape (latent, latent).
    read: shape (inputs, latent) with p = read z; None if p = z.
    """
    n, latent = len(model.A), len(transition)
    read = np.eye(latent) if read is None else read
    F = np.block([[model.A, model.B @ read], [np.zeros((latent, n)), transition]])
    return F, np.hstack([model.G, model.J @ read])


def augment_walks(model: InputStateModel, Q: Array, S: Array) -> tuple[Array, Array, Array]:
    """Return the matrices of [x, p] if each input is a random walk (Eq. 23).

    They are transition, measurement and noise, shapes (N, N), (m, N), (N, N) with N = n + inputs.
    """
    F, H = augment(model, np.eye(model.B.shape[1]))
    return F, H, block_diag(Q, S)


def make_augmented(model: InputStateModel, Q: Array, S: Array, R: Array, P0: Array) -> Filter:
    """Make the augmented Kalman filter.

    Q: covariance of the process noise w per step, shape (n, n).
    S: covariance of the inputs' change per step, shape (inputs, inputs).
    R: covariance of the sensors' noise, shape (m, m).
    P0: covariance of states and inputs one step before the first measurement, shape
        (n + inputs, n + inputs).
    Raises InputError if a matrix is no covariance, or R is singular.
    """
    F, H, noise = augment_walks(model, Q, S)
    return make_kalman(F, H, noise, R, P0)


def make_steady(model: InputStateModel, Q: Array, S: Array, R: Array) -> Filter:
    """Make the augmented Kalman filter that uses its steady gain from the first step on.

    The gain is that of the discrete algebraic Riccati equation, if all errors fade. If sensors
    leave a direction of state or input unseen, the equation has no such solution. Then the gain is
    the one at which the time-varying filter settles; the filter's `settled` is False if the gain
    had not settled after `LONGEST` steps.

    Parameters and errors are those of `make_augmented`.
    """
    return settle_at_once(*augment_walks(model, Q, S), R)


def settle_at_once(F: Array, H: Array, Q: Array, R: Array) -> Filter:
    """Make the filter of `make_steady` of a model x[k+1] = F x[k] + w, y = H x + v.

    Q, R: covariances of w and v. Raises InputError if R is no covariance, or singular.
    """
    check_noise(R)
    K, settled = _solve(F, H, Q, R), True
    if K is None:
        varying = make_kalman(F, H, Q, R, Q)
        K, settled = varying.K, varying.settled
    loop = F - K @ (H @ F)
    return Filter(loop, K, loop[None], K[None], settled)


def make_lagged(
    model: InputStateModel, Q: Array, S: Array, R: Array, P0: Array, lag: int
) -> Lagged:
    """Make the augmented Kalman filter with a smoother of fixed lag, in steps.

    The other parameters, and errors, are those of `make_augmented`.
    """
    F, H, noise = augment_walks(model, Q, S)
    return make_smoother(F, H, noise, R, P0, lag)


def _solve(F: Array, H: Array, Q: Array, R: Array) -> Array | None:
    try:
        P = solve_discrete_are(F.T, H.T, Q, R)
    except (np.linalg.LinAlgError, ValueError):
        return None
    S = H @ P @ H.T + R
    K = np.asarray(np.linalg.solve(S, H @ P).T)
    radius = np.abs(np.linalg.eigvals(F - K @ (H @ F))).max()
    return K if radius < 1.0 - FADING else None
