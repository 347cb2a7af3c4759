"""Linear filters that estimate states and unknown inputs of a model, with gains that settle.

The gains of a linear filter depend on the model and on covariances, not on what is measured. So a
filter is made once, and then runs over any number of records. Gains change from step to step at
first; once they have settled, they stay.

Covariances are propagated by their square roots (`square_root`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.discretisation import hold_input
from owtsweep.estimation.square_root import Correction, deviation, kalman

#: Gains have settled once typical corrections change, from one step to the next, by less than this
#: part of the standard deviation of what they correct ...
TOLERANCE = 1e-10
#: ... in so many steps, one after the other.
QUIET_STEPS = 5
#: Most steps for which gains are computed. After these steps, the last gain stays, settled or not.
LONGEST = 6000


@dataclass(frozen=True)
class InputStateModel:
    """The model x[k+1] = A x[k] + B p[k] + w[k], y[k] = G x[k] + J p[k] + v[k] in discrete time.

    Eqs. (14) and (15) of Simpson et al. (2025), for n states x, inputs p that nobody measures, and
    m measurements y.

    A, B: transition matrix (n, n) and input matrix (n, inputs).
    G, J: measurement matrix (m, n) and direct feedthrough (m, inputs).
    step: time from k to k + 1, in s.
    """

    A: Array
    B: Array
    G: Array
    J: Array
    step: float


def hold_inputs(A: Array, B: Array, G: Array, J: Array, step: float) -> InputStateModel:
    """Turn x' = A x + B p, y = G x + J p into a discrete model with inputs held over each step.

    Eq. (16) of Simpson et al. (2025) needs the inverse of A, and a structure that is free to move
    has none: see `hold_input`.
    (`discretise` is not used: its covariance takes the exponential of -A, which overflows for
    stiffly damped modes.) Shapes are those of `InputStateModel`; `step` is in s.
    """
    return InputStateModel(*hold_input(A, B, step), np.asarray(G), np.asarray(J), step)


class Step(NamedTuple):
    """One step of a linear filter: x^[k] = F x^[k-1] + K y[k].

    `states` are standard deviations (N,) of the estimate's error, in which changes are judged.
    `corrections` is K times a root of the innovation's covariance, shape (N, m): how much typical
    measurements correct the estimate.
    """

    F: Array
    K: Array
    states: Array
    corrections: Array


@dataclass(frozen=True)
class Filter:
    """A linear filter x^[k] = F[k] x^[k-1] + K[k] y[k] that begins with x^ = 0.

    F, K: the closed loop (N, N) and the gain (N, m) once the gains have settled.
    early_F, early_K: closed loops (steps, N, N) and gains (steps, N, m) of the first steps.
    settled: whether the gains settled within `LONGEST` steps. If not, F and K are those of the last
        step that was computed.
    outputs: matrix (n + inputs, N) that takes states and inputs of the model from the filter's own
        states; None if these are the same.
    """

    F: Array
    K: Array
    early_F: Array
    early_K: Array
    settled: bool
    outputs: Array | None = None

    @property
    def radius(self) -> float:
        """The spectral radius of the settled closed loop F; errors grow if it is above 1."""
        if not np.all(np.isfinite(self.F)):
            return float("inf")
        return float(np.abs(np.linalg.eigvals(self.F)).max())

    def run(self, y: Array) -> Array:
        """Return estimates of each step from the measurements y (steps, m) up to this step.

        The shape is (steps, n + inputs): the states of the model, then its inputs.
        """
        x = self.run_states(y)
        return x if self.outputs is None else x @ self.outputs.T

    def run_states(self, y: Array) -> Array:
        """Filter a record like `run`, and return the filter's own states, shape (steps, N)."""
        from owtsweep.estimation.recursion import recur  # numba is slow to import

        x = y @ self.K.T
        early = min(len(y), len(self.early_K))
        x[:early] = np.matmul(self.early_K[:early], y[:early, :, None])[:, :, 0]
        transposed = np.ascontiguousarray(np.swapaxes(self.early_F[:early], 1, 2))
        recur(transposed, np.ascontiguousarray(self.F.T), x)
        return x


def settle(steps: Iterator[Step], outputs: Array | None = None) -> Filter:
    """Make a filter of its steps, which are computed until the gain has settled.

    The gain counts as settled after `QUIET_STEPS` steps with changes below `TOLERANCE`. Gains are
    watched rather than covariances: where sensors do not see a direction of state, its variance
    grows for ever while the gain settles. If the gain has not settled after `LONGEST` steps, or
    when covariances have grown beyond what numbers can hold, the last gain stays.
    """
    made: list[Step] = []
    quiet = 0
    try:
        for step in islice(steps, LONGEST):
            quiet = quiet + 1 if made and _is_quiet(made[-1], step) else 0
            made.append(step)
            if quiet == QUIET_STEPS:
                break
    except np.linalg.LinAlgError:  # one direction has outgrown all others
        if not made:
            raise
    return Filter(
        F=made[-1].F,
        K=made[-1].K,
        early_F=np.array([step.F for step in made]),
        early_K=np.array([step.K for step in made]),
        settled=quiet == QUIET_STEPS,
        outputs=outputs,
    )


def _is_quiet(before: Step, step: Step) -> bool:
    change = np.max(np.abs(step.corrections - before.corrections), axis=1)
    return bool(np.all(change <= TOLERANCE * step.states))


def make_kalman(
    F: Array, H: Array, Q: Array, R: Array, P0: Array, outputs: Array | None = None
) -> Filter:
    """Make the Kalman filter of x[k+1] = F x[k] + w[k], y[k] = H x[k] + v[k].

    Parameters and errors are those of `kalman`; `outputs` is that of `Filter`.
    """
    return settle((to_step(F, H, made) for made in kalman(F, H, Q, R, P0)), outputs)


def to_step(F: Array, H: Array, made: Correction) -> Step:
    """Turn the gain of a Kalman filter with matrices F and H into a step of a `Filter`."""
    return Step(F - made.K @ (H @ F), made.K, deviation(made.predicted), made.corrections)
