"""Turn a model in continuous time into a model in discrete time, Eq. (10) of Ren et al. (2019)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array

METHODS = ("exact", "first_order")


@dataclass(frozen=True)
class Model:
    """The model x' = A x + B u + w in continuous time, where w is white noise of intensity Q.

    Attributes
    ----------
    A
        System matrix, shape (states, states), in SI units.
    B
        Input matrix, shape (states, inputs), in SI units.
    Q
        Intensity of the white noise w, shape (states, states): covariance per second, in SI units.
    """

    A: Array
    B: Array
    Q: Array


@dataclass(frozen=True)
class Discrete:
    """The model x[k+1] = A x[k] + B u[k] + w[k] in discrete time.

    Attributes
    ----------
    A
        Transition matrix, shape (states, states).
    B
        Input matrix, shape (states, inputs); the input u[k] is constant from k to k + 1.
    Q
        Covariance of the noise w[k], shape (states, states).
    step
        Time from k to k + 1, in s.
    """

    A: Array
    B: Array
    Q: Array
    step: float


def discretise(model: Model, step: float, method: str = "exact") -> Discrete:
    """Turn a model in continuous time into a discrete one, with the input constant over a step.

    Parameters
    ----------
    model
        The model in continuous time.
    step
        Length T of a step, in s.
    method
        "exact" computes the integrals of Eq. (10) of Ren et al. (2019). "first_order" computes the
        approximation printed with Eq. (10): A becomes I + A T (10c), B becomes T B + T^2/2 A B
        (10d), and Q becomes Q T + Q A T^2 + A Q A' T^3/3 (10e). Of the new Q only the symmetric
        part is kept, since a covariance is symmetric.

    Raises
    ------
    ValueError
        If `method` is not one of `METHODS`.
    """
    from scipy.linalg import expm

    A, B, Q = model.A, model.B, model.Q
    n, m = B.shape
    if method == "first_order":
        printed = Q * step + Q @ A * step**2 + A @ Q @ A.T * step**3 / 3.0
        return Discrete(
            A=np.eye(n) + A * step,
            B=step * B + step**2 / 2.0 * A @ B,
            Q=0.5 * (printed + printed.T),
            step=step,
        )
    if method != "exact":
        raise ValueError(f"method is {method!r}, not one of {METHODS}")
    augmented = np.zeros((n + m, n + m))
    augmented[:n, :n], augmented[:n, n:] = A, B
    transition = expm(augmented * step)
    van_loan = expm(np.block([[-A, Q], [np.zeros((n, n)), A.T]]) * step)
    Ad = van_loan[n:, n:].T
    Qd = Ad @ van_loan[:n, n:]
    return Discrete(A=Ad, B=transition[:n, n:], Q=0.5 * (Qd + Qd.T), step=step)
