"""Brute force for filters and smoothers: the joint Gaussian of all states, conditioned on data.

The states of a record are one long vector. Its mean and covariance follow from writing out
x[k] = F[k-1] ... F[0] x[0] + sums of the noises, and one conditioning on all measurements at once
gives every state's mean and covariance. Nothing here is recursive in what is measured.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.estimation.linear import LinearModel

Array = NDArray[np.float64]


class Case(NamedTuple):
    """A model with a prior, and data that it may have made.

    truth (series, steps, n), z (series, steps, m), inputs (steps, p) or None.
    """

    model: LinearModel
    mean: Array
    covariance: Array
    inputs: Array | None
    truth: Array
    z: Array


class Joint:
    """The joint distribution of the states and measurements of some steps."""

    def __init__(self, case: Case) -> None:
        model, steps = case.model, case.z.shape[1]
        n, m = model.states, model.measurements
        self.n, self.m = n, m
        # x = offset + M (x0 - mean, w0, w1, ...)
        M = np.zeros((steps, n, steps, n))
        noise = np.zeros((steps, n, steps, n))
        offset = np.zeros((steps, n))
        offset[0], noise[0, :, 0], M[0, :, 0] = case.mean, case.covariance, np.eye(n)
        for k in range(steps - 1):
            F, Q, _, _, B = model.at(k)
            offset[k + 1] = F @ offset[k]
            if B is not None and case.inputs is not None:
                offset[k + 1] += B @ case.inputs[k]
            M[k + 1] = np.tensordot(F, M[k], 1)
            M[k + 1, :, k + 1] += np.eye(n)
            noise[k + 1, :, k + 1] = Q
        flat, N = M.reshape(steps * n, -1), noise.reshape(steps * n, -1)
        self.mean, self.covariance = offset.ravel(), flat @ N @ flat.T
        self.H, self.R = np.zeros((steps * m, steps * n)), np.zeros((steps * m, steps * m))
        for k in range(steps):
            _, _, H, R, _ = model.at(k)
            self.H[k * m : (k + 1) * m, k * n : (k + 1) * n] = H
            self.R[k * m : (k + 1) * m, k * m : (k + 1) * m] = R

    def condition(self, z: Array, used: NDArray[np.bool_], step: int) -> tuple[Array, Array]:
        """Mean and covariance of one step's state, given the marked ones of z (steps, m)."""
        at = slice(step * self.n, (step + 1) * self.n)
        chosen = np.flatnonzero(used.ravel())
        H, R = self.H[chosen], self.R[np.ix_(chosen, chosen)]
        cross = self.covariance[at] @ H.T
        S = H @ self.covariance @ H.T + R
        gain = np.linalg.solve(S, cross.T).T
        residual = z.ravel()[chosen] - H @ self.mean
        return self.mean[at] + gain @ residual, self.covariance[at, at] - gain @ cross.T

    def quadratic(self, z: Array, used: NDArray[np.bool_]) -> float:
        """The marked measurements' squared distance from their mean, in their covariance."""
        chosen = np.flatnonzero(used.ravel())
        H = self.H[chosen]
        S = H @ self.covariance @ H.T + self.R[np.ix_(chosen, chosen)]
        residual = z.ravel()[chosen] - H @ self.mean
        return float(residual @ np.linalg.solve(S, residual))


def draw_case(
    seed: int,
    n: int,
    m: int,
    *,
    steps: int = 14,
    series: int = 2,
    changing: bool = False,
    inputs: int = 0,
    lost: float = 0.0,
    rank: int | None = None,
) -> Case:
    """A random stable model, data of it, and losses.

    Parameters
    ----------
    changing
        Whether all matrices change from step to step.
    lost
        Probability of each component's loss.
    rank
        Of Q and of the prior's covariance; n if None.
    """
    random = np.random.default_rng(seed)
    lead = (steps,) if changing else ()

    def covariance(size: int, rank: int | None, *lead: int) -> Array:
        half = random.normal(size=(*lead, size, size if rank is None else rank))
        return half @ np.swapaxes(half, -1, -2)

    F = random.normal(size=(*lead, n, n))
    F *= 0.95 / np.max(np.abs(np.linalg.eigvals(F)), axis=-1)[..., None, None]
    model = LinearModel(
        F=F,
        Q=covariance(n, rank, *lead),
        H=random.normal(size=(*lead, m, n)),
        R=covariance(m, None, *lead) + 0.1 * np.eye(m),
        B=random.normal(size=(*lead, n, inputs)) if inputs else None,
    )
    mean, P = random.normal(size=n), covariance(n, rank)
    u = random.normal(size=(steps, inputs)) if inputs else None
    truth, z = simulate(model, mean, P, u, series, steps, random)
    z[random.random(z.shape) < lost] = np.nan
    return Case(model, mean, P, u, truth, z)


def simulate(
    model: LinearModel,
    mean: Array,
    covariance: Array,
    inputs: Array | None,
    series: int,
    steps: int,
    random: np.random.Generator,
) -> tuple[Array, Array]:
    """States (series, steps, n) and measurements (series, steps, m) of a model."""

    def noise(P: Array) -> Array:
        return random.multivariate_normal(np.zeros(len(P)), P, size=series, method="eigh")

    truth = np.empty((series, steps, model.states))
    z = np.empty((series, steps, model.measurements))
    x = mean + noise(covariance)
    for k in range(steps):
        F, Q, H, R, B = model.at(k)
        truth[:, k], z[:, k] = x, x @ H.T + noise(R)
        x = x @ F.T + noise(Q)
        if B is not None and inputs is not None:
            x = x + B @ inputs[k]
    return truth, z
