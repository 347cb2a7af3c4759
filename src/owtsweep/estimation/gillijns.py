"""The joint input and state filter of Gillijns and De Moor, for models with direct feedthrough.

Gillijns and De Moor, "Unbiased minimum-variance input and state estimation for linear discrete-time
systems with direct feedthrough", Automatica 43 (2007). Nothing is believed of the inputs: at each
step, weighted least squares solve the innovation for them; what is left of the innovation corrects
the state. Estimates are unbiased whatever the inputs are, and no linear unbiased estimate has less
variance.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.estimation.input_state import (
    Filter,
    InputStateModel,
    Step,
    check_noise,
    combine,
    deviation,
    root_of,
    settle,
)

#: A singular value of the scaled feedthrough below this part of the largest one counts as zero.
RANK_TOLERANCE = 1e-9


def make_gillijns(model: InputStateModel, Q: Array, R: Array, P0: Array) -> Filter:
    """Make the joint input and state filter.

    Parameters
    ----------
    model
        The model of n states and its inputs. The feedthrough J needs as many independent columns as
        there are inputs.
    Q
        Covariance of the process noise w per step, shape (n, n).
    R
        Covariance of the sensors' noise, shape (m, m).
    P0
        Covariance of the state at the first measurement, shape (n, n). (A step before the first
        measurement, as in the other filters, would need the input there.)

    Raises
    ------
    InputError
        If the rank of J is too small, a matrix is no covariance, or R is singular.
    """
    rank, inputs = find_feedthrough_rank(model.J), model.J.shape[1]
    require(
        rank == inputs,
        f"J: its rank is {rank}, but there are {inputs} inputs; Gillijns and De Moor's filter "
        "needs as many independent accelerations as inputs",
    )
    return settle(_steps(model, root_of("Q", Q), check_noise(R), root_of("P0", P0)))


def find_feedthrough_rank(J: Array) -> int:
    """Return the rank of a feedthrough matrix J (m, inputs), whatever the units of its inputs."""
    size = np.linalg.norm(J, axis=0)
    scaled = J / np.where(size > 0.0, size, 1.0)
    return int(np.linalg.matrix_rank(scaled, tol=RANK_TOLERANCE * np.sqrt(J.shape[1])))


def _steps(model: InputStateModel, root_Q: Array, root_R: Array, root: Array) -> Iterator[Step]:
    """Yield the steps of the filter whose state is [x, p].

    With the gains M of the input and L of the state (M J = I and L J = 0), errors of the estimates
    of x and p at k are linear in the prediction's error e and in the noise v:
    (I - L G) e - L v, and -M G e - M v.
    """
    G, J = model.G, model.J
    both = np.hstack([model.A, model.B])
    n = len(model.A)
    while True:
        seen = combine(G @ root, root_R)  # root of the innovation's covariance for known input
        white = np.linalg.solve(seen, J)
        q, r = np.linalg.qr(white)
        M = np.linalg.solve(r, np.linalg.solve(seen.T, q).T)
        gain = np.linalg.solve(seen.T, np.linalg.solve(seen, G @ root) @ root.T).T
        L = gain - (gain @ J) @ M
        gains = np.vstack([L, M])
        predict = np.vstack([np.eye(n), np.zeros((len(M), n))]) - gains @ G
        inner = predict @ both
        yield Step(
            inner,
            gains,
            np.concatenate([deviation(root), deviation(M @ seen)]),
            deviation(root_R),
        )
        errors = combine(predict @ root, gains @ root_R)
        root = combine(both @ errors, root_Q)
