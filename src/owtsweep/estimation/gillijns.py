"""The joint input and state filter of Gillijns and De Moor, for models with direct feedthrough.

Gillijns and De Moor, "Unbiased minimum-variance input and state estimation for linear discrete-time
systems with direct feedthrough", Automatica 43 (2007). Nothing is assumed of the inputs: at each
step, weighted least squares solve the innovation for them; what is left of the innovation corrects
the state. Estimates are unbiased whatever the inputs are, and no linear unbiased estimate has less
variance.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.input_state import Filter, InputStateModel, Step, settle
from owtsweep.estimation.square_root import check_noise, combine, deviation, overflows, root_of

#: A singular value of the scaled feedthrough below this part of the largest one counts as zero.
RANK_TOLERANCE = 1e-9


def make_gillijns(model: InputStateModel, Q: Array, R: Array, P0: Array) -> Filter:
    """Make the joint input and state filter.

    model: its feedthrough J needs as many independent columns as there are inputs.
    Q, R: as of `augmented.make_augmented`.
    P0: covariance of the state at the first measurement, shape (n, n). (A step before the first
        measurement, as in the other filters, would need the input there.)
    Raises InputError if a matrix is no covariance, or R is singular.
    """
    return settle(_steps(model, root_of(Q), check_noise(R), root_of(P0)))


def find_feedthrough_rank(J: Array) -> int:
    """Return the rank of a feedthrough matrix J (m, inputs), whatever the units of its inputs."""
    size = np.linalg.norm(J, axis=0)
    scaled = J / np.where(size > 0.0, size, 1.0)
    return int(np.linalg.matrix_rank(scaled, tol=RANK_TOLERANCE * np.sqrt(J.shape[1])))


def _steps(model: InputStateModel, root_Q: Array, root_R: Array, root: Array) -> Iterator[Step]:
    """Yield the steps of the filter whose state is [x, p], until its covariances overflow.

    With known input, the innovation would be e = T u with its root T and unit white noise u, and
    the state would be corrected by C u. Whitened, the innovation with unknown input is
    T^-1 J p + u. With the factors q r of T^-1 J, least squares give the input r^-1 q' of it. The
    error r^-1 q' u of the input moves the state by -C q q' u.
    """
    A, B, G, J = model.A, model.B, model.G, model.J
    n, inputs = B.shape
    m = len(G)
    both = np.hstack([A, B])
    no_input = np.zeros((inputs, n))
    while not overflows(root):
        made = combine(np.vstack([root_R, np.zeros((n, m))]), np.vstack([G @ root, root]))
        T, C, known = made[:m, :m], made[m:, :m], made[m:, m:]
        q, r = np.linalg.qr(np.linalg.solve(T, J))
        solve_r = np.linalg.inv(r)
        corrections = np.vstack([C - C @ q @ q.T, solve_r @ q.T])
        gains = np.linalg.solve(T.T, corrections.T).T
        predict = np.vstack([np.eye(n), no_input]) - gains @ G
        errors = np.block([[known, -C @ q], [no_input, solve_r]])
        yield Step(predict @ both, gains, deviation(errors), corrections)
        root = combine(both @ errors, root_Q)
