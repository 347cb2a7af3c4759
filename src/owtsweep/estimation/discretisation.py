"""Turn a model in continuous time into a model in discrete time, Eq. (10) of Ren et al. (2019)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from owtsweep.arrays import Array

METHODS = ("exact", "first_order")
HOLDS = ("zero", "first")


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
    """The model x[k+1] = A x[k] + B u[k] + B_next u[k+1] + w[k] in discrete time.

    Attributes
    ----------
    A
        Transition matrix, shape (states, states).
    B
        Input matrix, shape (states, inputs).
    Q
        Covariance of the noise w[k], shape (states, states).
    step
        Time from k to k + 1, in s.
    B_next
        Matrix of the input at the end of the step, shape (states, inputs), if the input is linear
        from k to k + 1 (a first-order hold). None if the input u[k] is constant from k to k + 1 (a
        zero-order hold).
    """

    A: Array
    B: Array
    Q: Array
    step: float
    B_next: Array | None = None


def discretise(model: Model, step: float, method: str = "exact", *, hold: str = "zero") -> Discrete:
    """Turn a model in continuous time into a discrete one.

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
    hold
        What the input does between samples. "zero": the input is constant over a step (zero-order
        hold). "first": the input is linear between the samples at both ends of a step (first-order
        hold, also called triangle hold). The paper has the zero-order hold only.

    Raises
    ------
    ValueError
        If `method` is not one of `METHODS`, or `hold` not one of `HOLDS`.
    """
    from scipy.linalg import expm

    if hold not in HOLDS:
        raise ValueError(f"hold is {hold!r}, not one of {HOLDS}")
    if hold == "first":
        return _hold_linearly(model, discretise(model, step, method), method)
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


def _hold_linearly(model: Model, held: Discrete, method: str) -> Discrete:
    """Return the discrete model with an input that is linear over a step.

    `held` is the discrete model with an input that is constant over a step. An input that rises
    from 0 to 1 over a step changes the state by B_next. An input that falls from 1 to 0 changes the
    state by the rest of what a constant input of 1 does.
    """
    from scipy.linalg import expm

    A, B, step = model.A, model.B, held.step
    n, m = B.shape
    if method == "first_order":
        rising = step / 2.0 * B + step**2 / 6.0 * A @ B
    else:
        augmented = np.zeros((n + 2 * m, n + 2 * m))
        augmented[:n, :n], augmented[:n, n : n + m] = A, B
        augmented[n : n + m, n + m :] = np.eye(m) / step
        rising = expm(augmented * step)[:n, n + m :]
    return replace(held, B=held.B - rising, B_next=rising)
