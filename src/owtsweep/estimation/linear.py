"""The linear Gaussian model in discrete time that filters and smoothers use.

    x[k+1] = F[k] x[k] + B[k] u[k] + w[k],  E[w w'] = Q[k]
    z[k]   = H[k] x[k] + v[k],              E[v v'] = R[k]

w and v are white and independent of each other (Kalman 1960; Anderson and Moore 1979, section 3.1).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError

#: Largest asymmetry and most negative eigenvalue of a covariance that still count as round-off,
#: relative to its largest entry.
ROUND_OFF = 1e-9


class Step(NamedTuple):
    """The matrices of a `LinearModel` for one step; B is None if the model has no inputs."""

    F: Array
    Q: Array
    H: Array
    R: Array
    B: Array | None


@dataclass(frozen=True)
class LinearModel:
    """The model x[k+1] = F x[k] + B u[k] + w[k], z[k] = H x[k] + v[k].

    The state x has n components, the measurement z has m, the input u has p. Each matrix may have a
    leading axis of time, (steps, ...). A matrix without this axis serves all steps.

    Attributes
    ----------
    F
        Transition matrix (n, n) from step k to step k + 1.
    Q
        Covariance (n, n) of the process noise w that acts between step k and step k + 1.
    H
        Measurement matrix (m, n).
    R
        Covariance (m, m) of the measurement noise v.
    B
        Input matrix (n, p) of the input u that acts between step k and step k + 1; None if the
        model has no inputs.

    Raises
    ------
    InputError
        If shapes do not fit, a number is not finite, or Q or R is not symmetric and positive
        semidefinite.
    """

    F: Array
    Q: Array
    H: Array
    R: Array
    B: Array | None = None

    def __post_init__(self) -> None:
        names = ("F", "Q", "H", "R") if self.B is None else ("F", "Q", "H", "R", "B")
        matrices = {name: np.array(getattr(self, name), dtype=float) for name in names}
        for name, matrix in matrices.items():
            if matrix.ndim not in (2, 3):
                raise InputError(
                    f"{name}: has {matrix.ndim} axes; give a matrix, or (steps, rows, columns)"
                )
            matrix.setflags(write=False)
            object.__setattr__(self, name, matrix)
        n, m = self.states, self.measurements
        shapes = {"F": (n, n), "Q": (n, n), "H": (m, n), "R": (m, m)}
        for name, matrix in matrices.items():
            shape = shapes.get(name, (n, matrix.shape[-1]))
            if matrix.shape[-2:] != shape:
                raise InputError(
                    f"{name}: has the shape {matrix.shape[-2:]}; {n} states and {m} measurements "
                    f"need {shape}"
                )
        lengths = {name: len(matrix) for name, matrix in matrices.items() if matrix.ndim == 3}
        if len(set(lengths.values())) > 1:
            said = ", ".join(f"{name} for {length}" for name, length in lengths.items())
            raise InputError(
                f"{next(iter(lengths))}: matrices are given for different numbers of steps ({said})"
            )
        for name, matrix in matrices.items():
            if not np.all(np.isfinite(matrix)):
                raise InputError(f"{name}: not all of its numbers are finite")
        check_covariance("Q", self.Q)
        check_covariance("R", self.R)

    @property
    def states(self) -> int:
        """The number of states, n."""
        return int(self.F.shape[-1])

    @property
    def measurements(self) -> int:
        """The number of components of a measurement, m."""
        return int(self.H.shape[-2])

    @property
    def steps(self) -> int | None:
        """The number of steps for which there are matrices; None if no matrix depends on time."""
        matrices = (self.F, self.Q, self.H, self.R, self.B)
        return next((len(a) for a in matrices if a is not None and a.ndim == 3), None)

    def at(self, step: int) -> Step:
        """Return the matrices of the step with number `step`, counted from 0."""
        matrices: Any = (self.F, self.Q, self.H, self.R, self.B)
        return Step(*(a if a is None or a.ndim == 2 else a[step] for a in matrices))


def check_covariance(name: str, matrix: Array) -> None:
    """Check that a matrix (n, n), or each of several matrices (..., n, n), is a covariance.

    Raises
    ------
    InputError
        If a matrix is not symmetric and positive semidefinite, apart from round-off. The message
        begins with `name`.
    """
    transposed = np.swapaxes(matrix, -1, -2)
    largest = np.max(np.abs(matrix), initial=0.0)
    if np.any(np.abs(matrix - transposed) > ROUND_OFF * largest):
        raise InputError(f"{name}: is not symmetric; give a symmetric matrix")
    least = np.min(np.linalg.eigvalsh(matrix), initial=0.0)
    if least < -ROUND_OFF * largest:
        raise InputError(
            f"{name}: has the negative eigenvalue {least:.3g}; give a covariance, which has none"
        )
