"""Reduce a beam to few modes: free-interface component modes (Simpson et al. 2025, section 2.1).

The basis holds the rigid modes, free-interface normal modes (Eq. 5), and residual inertia-relief
attachment (RIRA) modes (Eqs. 6-8), one per interface degree of freedom. With them the answer to
static interface loads is exact. All modes are scaled to a modal mass of 1 and orthogonal to each
other, so the reduced mass matrix is the identity and the reduced stiffness diagonal. (The paper
leaves the attachment modes as Eq. (8) gives them; scaling does not change the space they span.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.structures.bernoulli import PlaneBeam


@dataclass(frozen=True)
class Reduced:
    """A beam in few coordinates: u = basis z, with z'' + damping z' + stiffness z = basis' f.

    basis: Displacements (m, rad) of the degrees of freedom for unit coordinates, shape (dof,
        modes). Modal masses are 1 (kg).
    omega: Angular frequencies of the coordinates in rad/s, shape (modes,); 0 for rigid modes.
    kinds: "rigid", "normal" or "attachment" for each coordinate.
    """

    basis: Array
    omega: Array
    kinds: tuple[str, ...]

    @property
    def stiffness(self) -> Array:
        """The reduced stiffness matrix, shape (modes, modes), s^-2."""
        return np.diag(self.omega**2)


def reduce_free(
    beam: PlaneBeam,
    interfaces: Sequence[int],
    normal: int,
    *,
    constrained: Sequence[int] = (0, 1),
) -> Reduced:
    """Reduce a free beam to rigid, normal and residual inertia-relief attachment modes.

    Raise `InputError` if the beam has fewer modes.

    interfaces: Degrees of freedom on which unknown forces and moments act.
    normal: Number of free-interface normal modes, lowest first.
    constrained: two degrees of freedom that are held while Eq. (7) is solved. They must hold the
        beam without strain. (The print's step 4 has as many as interfaces; holding more than the
        rigid modes strains the beam.) The result does not depend on them.
    """
    from scipy.linalg import eigh

    K, M = beam.stiffness, beam.mass
    size = len(M)
    require(
        0 <= normal <= size - 2 - len(interfaces),
        f"model.modes: {normal} normal modes; the substructure of {size // 2} nodes has room for "
        f"{size - 2 - len(interfaces)}",
    )
    rigid = _rigid_modes(beam)
    # The stiffness of rigid motion is zero but for rounding (and softening by weight).
    shifted = K + np.max(np.abs(np.diag(K) / np.diag(M))) * (M @ rigid) @ (M @ rigid).T
    square, vectors = eigh(shifted, M, subset_by_index=[0, max(normal, 1) - 1])
    square, modes = square[:normal], vectors[:, :normal]
    loads = np.zeros((size, len(interfaces)))
    loads[list(interfaces), np.arange(len(interfaces))] = 1.0
    relieved = loads - M @ rigid @ (rigid.T @ loads)  # P_r of step 3, self-balanced
    rest = np.setdiff1d(np.arange(size), constrained)
    answer = np.zeros_like(loads)
    answer[rest] = np.linalg.solve(K[np.ix_(rest, rest)], relieved[rest])
    answer -= rigid @ (rigid.T @ (M @ answer))  # P_r' of Eq. (8)
    attachment = answer - modes @ ((modes.T @ loads) / square[:, None])
    flexibility, inertia = attachment.T @ K @ attachment, attachment.T @ M @ attachment
    scale = 1.0 / np.sqrt(np.diag(inertia))
    own, mixing = eigh(flexibility * np.outer(scale, scale), inertia * np.outer(scale, scale))
    attached = attachment @ (scale[:, None] * mixing)
    others = np.hstack([rigid, modes])
    attached -= others @ (others.T @ (beam.mass @ attached))  # rounding of the static solution
    return Reduced(
        basis=np.hstack([others, attached]),
        omega=np.sqrt(np.concatenate([np.zeros(2), square, own])),
        kinds=("rigid",) * 2 + ("normal",) * normal + ("attachment",) * len(interfaces),
    )


def reduce_held(beam: PlaneBeam, count: int) -> Reduced:
    """Reduce a beam that soil, a foundation or a clamp holds to its `count` lowest modes.

    Raise `InputError` if the beam has fewer modes, or buckles under its weight.
    """
    from scipy.linalg import eigh

    free = beam.free
    require(
        1 <= count <= len(free),
        f"model.whole_modes: {count}; give 1 to {len(free)}, as many as degrees of freedom",
    )
    at = np.ix_(free, free)
    square, vectors = eigh(beam.stiffness[at], beam.mass[at], subset_by_index=[0, count - 1])
    require(
        bool(square[0] > 0.0), "structure: it buckles under its own weight; make its tubes thicker"
    )
    basis = np.zeros((len(beam.mass), count))
    basis[free] = vectors
    return Reduced(basis, np.sqrt(square), ("normal",) * count)


def _rigid_modes(beam: PlaneBeam) -> Array:
    """Return translation, and rotation about the centre of mass, scaled to modal masses of 1."""
    shift = np.zeros(len(beam.mass))
    shift[0::2] = 1.0
    turn = np.zeros(len(beam.mass))
    turn[0::2], turn[1::2] = beam.heights, 1.0
    mass = shift @ beam.mass @ shift
    turn -= shift * (shift @ beam.mass @ turn) / mass
    return np.stack([shift / np.sqrt(mass), turn / np.sqrt(turn @ beam.mass @ turn)], axis=1)
