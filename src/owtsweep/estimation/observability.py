"""Find what sensors do not see of a linear model: the test of Popov, Belevitch and Hautus.

A direction v of state stays unseen for ever if and only if it lies in the null space of the matrix
[A - lambda I; G] for an eigenvalue lambda of A (Kailath 1980, section 2.4), or in a chain that such
directions begin: (A - lambda I) v is unseen, and G v = 0. Chains matter where A has Jordan blocks.
A structure that moves rigidly is one: with inclinometers and accelerometers, its position is
unseen, and a constant velocity too, for the position is all that the velocity changes. The rank of
the matrix tells of the position only. But both keep an eigenvalue of 1 in every filter's closed
loop.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array

#: A singular value below this part of the largest one counts as zero.
TOLERANCE = 1e-9
#: Eigenvalues are the same if they differ by less than this (above 1: by this part of themselves).
#: Rounding splits the eigenvalues of a Jordan block of size 2 by the root of the floating-point
#: accuracy, 1e-8, and those of size 3 by 1e-5.
SAME = 1e-5


@dataclass(frozen=True)
class Unseen:
    """What sensors do not see at one eigenvalue.

    eigenvalue: of A. Of a complex pair, the one with positive imaginary part.
    lacking: by how much the rank of [A - lambda I; G] is below n.
    directions: orthonormal directions of state, shape (n, directions): first those in the null
        space, then those of the chains, so there may be more than `lacking`. Complex if the
        eigenvalue is.
    """

    eigenvalue: complex
    lacking: int
    directions: Array

    @property
    def count(self) -> int:
        """The number of real directions of state: twice the columns for a complex pair."""
        columns = int(self.directions.shape[1])
        return 2 * columns if self.eigenvalue.imag else columns


@dataclass(frozen=True)
class Observability:
    """What sensors see of a model with n states.

    rank: the dimension of what sensors see: the rank of the observability matrix, n if all is seen.
    conditions: largest singular value of [A - lambda I; G] over the smallest one that is not zero,
        for each distinct eigenvalue of A (of complex pairs one), shape (eigenvalues,). If large,
        the eigenvalue's directions are seen, but badly.
    unseen: what is not seen, per eigenvalue.
    """

    states: int
    rank: int
    conditions: Array
    unseen: tuple[Unseen, ...]


def find_unobservable(A: Array, G: Array) -> Observability:
    """Find the directions of state that sensors never see, by the test of Popov-Belevitch-Hautus.

    A: matrix of a model in discrete time (x[k+1] = A x[k]) or in continuous time (x' = A x), shape
        (n, n). For inputs too, give the augmented matrices (`augmented.augment`).
    G: measurement matrix, shape (m, n).
        Rows are divided by their norms, since the unit of a sensor does not matter.
    """
    from scipy.linalg import matrix_balance

    n = len(A)
    size = matrix_balance(A, permute=False, separate=True)[1][0]  # whatever the units of states
    scaled = A * size / size[:, None]
    rows = G * size
    norms = np.linalg.norm(rows, axis=1, keepdims=True)
    rows = np.divide(rows, norms, out=np.zeros_like(rows), where=norms > 0.0)
    conditions, unseen = [], []
    for value, count in _distinct(scaled):
        shifted = scaled - (value if value.imag else value.real) * np.eye(n)
        null, singular = _null_space(np.vstack([shifted, rows]))
        seen = singular[: n - null.shape[1]]
        conditions.append(seen[0] / seen[-1] if len(seen) else np.inf)
        if null.shape[1]:
            chain = _follow_chains(shifted, rows, null, count)
            directions = np.linalg.qr(size[:, None] * chain)[0]
            unseen.append(Unseen(value, null.shape[1], directions))
    rank = n - sum(found.count for found in unseen)
    return Observability(n, rank, np.array(conditions), tuple(unseen))


def _distinct(A: Array) -> Iterator[tuple[complex, int]]:
    """Yield the distinct eigenvalues without negative imaginary part, and their multiplicities.

    Eigenvalues that rounding has split are replaced by their mean, which is far more accurate.
    """
    left = list(np.linalg.eigvals(A).astype(complex))
    while left:
        near = SAME * max(1.0, abs(left[0]))
        group = [other for other in left if abs(other - left[0]) <= near]
        left = [other for other in left if abs(other - left[0]) > near]
        mean = complex(np.mean(group))
        if abs(mean.imag) <= near:
            mean = complex(mean.real)
        if mean.imag >= 0.0:
            yield mean, len(group)


def _null_space(matrix: Array) -> tuple[Array, Array]:
    """Return an orthonormal basis (n, directions) of the null space, and the singular values."""
    _, singular, vectors = np.linalg.svd(matrix)
    return vectors[singular <= TOLERANCE * singular[0]].conj().T, singular


def _follow_chains(shifted: Array, rows: Array, null: Array, multiplicity: int) -> Array:
    """Return all unseen directions (n, directions) of an eigenvalue, the given null space first.

    A direction v belongs to them if `rows` v = 0 and `shifted` v is one of them.
    """
    found = null
    while found.shape[1] < multiplicity:
        outside = shifted - found @ (found.conj().T @ shifted)
        wider, _ = _null_space(np.vstack([outside, rows]))
        if wider.shape[1] <= found.shape[1]:
            break
        new = wider - found @ (found.conj().T @ wider)
        left, _, _ = np.linalg.svd(new, full_matrices=False)
        found = np.hstack([found, left[:, : wider.shape[1] - found.shape[1]]])
    return found
