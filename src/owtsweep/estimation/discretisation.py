"""From continuous to discrete time, Eq. (10) of Ren et al. (2019)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array

METHODS = ("exact", "first_order")


@dataclass(frozen=True)
class Model:
    """x' = A x + B u + w with E[w w'] = Q delta(t); z = H x.

    Attributes
    ----------
    A, B, Q
        (states, states), (states, inputs), (states, states) in SI units per second.
    """

    A: Array
    B: Array
    Q: Array


@dataclass(frozen=True)
class Discrete:
    """x+ = A x + B u + w with E[w w'] = Q, the input held over the step."""

    A: Array
    B: Array
    Q: Array
    step: float


def discretise(model: Model, step: float, method: str = "exact") -> Discrete:
    """Discretise over `step` seconds with the input held.

    "exact" computes the integrals of Eq. (10): A and B by one augmented matrix exponential, Q by
    van Loan's method. "first_order" is the form printed in the paper: A = I + A T (10c),
    B = T B + T^2/2 A B (10d), and the sum of (10e), Q T + Q A T^2 + A Q A' T^3/3, of which only the
    symmetric part is kept, since a covariance is symmetric.
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
