"""Compute the lowest modes of vibration of a structure, by finite elements (scikit-fem).

Timoshenko's beam: deflection w(z) and rotation theta(z) of the cross-section, with the energies
(per length, halves left out)

    E I theta'^2 + kappa G A (w' - theta)^2 - N w'^2 + k_s w^2   and
    (rho A + m_w) w_t^2 + rho I theta_t^2,

where N is the compression by the weight above, k_s the soil's stiffness, and m_w the added mass of
the water (Cowper 1966 gives kappa of a thin tube). w is quadratic and theta linear in an element,
and the shear is integrated at two points, so thin beams do not lock.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.structures.description import Structure
from owtsweep.structures.sections import Sections, list_bodies

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix, csr_matrix
    from skfem import Basis

#: Longest element, m.
ELEMENT = 1.0
#: Order up to which polynomials are integrated exactly: two points for shear, three for the rest.
SHEAR_ORDER, ORDER = 3, 5


@dataclass(frozen=True)
class Beam:
    """The matrices of a structure's beam, for the degrees of freedom w, then theta.

    stiffness, mass: Sparse matrices, shape (n, n).
    heights, deflections: Heights (m) of the nodes of w, upwards, and their degrees of freedom.
    hub, hub_slope: Degrees of freedom of w and of theta at the hub, the highest node.
    free: Degrees of freedom that are not clamped.
    """

    stiffness: csc_matrix
    mass: csc_matrix
    heights: Array
    deflections: NDArray[np.intp]
    hub: int
    hub_slope: int
    free: NDArray[np.intp]


def assemble(structure: Structure, blades: int = 0) -> Beam:
    """Assemble the matrices of a structure with some blades mounted."""
    from scipy.sparse import bmat, lil_matrix
    from skfem import Basis, BilinearForm, ElementLineP1, ElementLineP2, MeshLine

    pieces = [
        np.linspace(low, high, int(np.ceil((high - low) / ELEMENT)) + 1)
        for low, high in pairwise(structure.ends())
    ]
    mesh = MeshLine(np.unique(np.concatenate(pieces)))
    elements = ElementLineP2(), ElementLineP1()
    of_w, of_theta = (Basis(mesh, element, intorder=ORDER) for element in elements)
    shear_w, shear_theta = (Basis(mesh, element, intorder=SHEAR_ORDER) for element in elements)
    section = Sections(structure, blades)

    def form(integrand: Callable[..., Array], *bases: Basis) -> csr_matrix:
        return BilinearForm(integrand).assemble(*bases)

    K_ww = (
        form(lambda w, v, p: section.shear(p.x[0]) * w.grad[0] * v.grad[0], shear_w)
        + form(lambda w, v, p: -section.compression(p.x[0]) * w.grad[0] * v.grad[0], of_w)
        + form(lambda w, v, p: section.soil(p.x[0]) * w * v, of_w)
    )
    K_wt = form(lambda t, v, p: -section.shear(p.x[0]) * t * v.grad[0], shear_theta, shear_w)
    K_tt = form(lambda t, u, p: section.shear(p.x[0]) * t * u, shear_theta) + form(
        lambda t, u, p: section.bending(p.x[0]) * t.grad[0] * u.grad[0], of_theta
    )
    M_ww = form(lambda w, v, p: section.mass(p.x[0]) * w * v, of_w)
    M_tt = form(lambda t, u, p: section.rotary(p.x[0]) * t * u, of_theta)

    order = np.argsort(of_w.doflocs[0])
    heights = of_w.doflocs[0][order]
    theta_heights = of_theta.doflocs[0]
    bodies_mass = lil_matrix((of_w.N + of_theta.N, of_w.N + of_theta.N))
    for height, mass, offset, inertia in list_bodies(structure, blades):
        w = order[np.argmin(np.abs(heights - height))]
        t = of_w.N + int(np.argmin(np.abs(theta_heights - height)))
        bodies_mass[w, w] += mass
        bodies_mass[w, t] += mass * offset
        bodies_mass[t, w] += mass * offset
        bodies_mass[t, t] += mass * offset**2 + inertia
    free = np.arange(of_w.N + of_theta.N)
    foot = [order[0], of_w.N + int(np.argmin(theta_heights))]
    springs = lil_matrix(bodies_mass.shape)
    if structure.foundation is not None:
        springs[np.ix_(foot, foot)] = structure.foundation.matrix()
    if structure.clamped:
        free = np.setdiff1d(free, foot)
    return Beam(
        stiffness=(bmat([[K_ww, K_wt], [K_wt.T, K_tt]]) + springs).tocsc(),
        mass=(bmat([[M_ww, None], [None, M_tt]]) + bodies_mass).tocsc(),
        heights=heights,
        deflections=order,
        hub=int(order[-1]),
        hub_slope=of_w.N + int(np.argmax(theta_heights)),
        free=free,
    )


@dataclass(frozen=True)
class Modes:
    """Modes of vibration, scaled so that the hub moves by 1 m.

    frequency: Natural frequencies in Hz, ascending, shape (modes,).
    mass: Modal masses in kg, shape (modes,): the kinetic energy is half of it times (velocity of
        the hub in this mode)^2.
    slope: Rotation of the cross-section at the hub per metre of the hub's displacement, rad/m,
        shape (modes,). Positive: the tower leans the way that the hub moves.
    heights, shape: Heights in m, shape (nodes,), upwards, and the deflections there, shape (nodes,
        modes).
    damping: Damping ratio of every mode.
    """

    frequency: Array
    mass: Array
    slope: Array
    heights: Array
    shape: Array
    damping: float

    def at(self, height: Array) -> Array:
        """Interpolate the modes' deflections at heights in m; shape (heights, modes)."""
        return np.stack(
            [np.interp(height, self.heights, column) for column in self.shape.T], axis=1
        )


def compute_modes(structure: Structure, count: int = 4, blades: int = 0) -> Modes:
    """Compute the `count` lowest modes of a structure with 0 to 3 blades mounted.

    Raise `InputError` if the structure has fewer degrees of freedom than modes are wanted, has no
    blade to mount, or buckles under its weight.
    """
    from scipy.sparse.linalg import eigsh

    require(
        blades == 0 or structure.blade is not None,
        f"blades: structure {structure.name} has no blade; give structure.blade, or blades 0",
    )
    beam = assemble(structure, blades)
    most = len(beam.free) - 2  # as many as the sparse solver can give
    require(
        1 <= count <= most,
        f"modes: {count} of structure {structure.name}; give 1 to {most}, because it has "
        f"{len(beam.free)} degrees of freedom",
    )
    K, M = (matrix[beam.free][:, beam.free] for matrix in (beam.stiffness, beam.mass))
    square, vectors = eigsh(K, k=count, M=M, sigma=0.0, v0=np.ones(K.shape[0]))
    order = np.argsort(square)
    square, vectors = square[order], vectors[:, order]
    require(
        bool(square[0] > 0.0),
        f"structure {structure.name}: it buckles under its own weight; make its tubes thicker",
    )
    full = np.zeros((beam.stiffness.shape[0], count))
    full[beam.free] = vectors
    full /= full[beam.hub]
    return Modes(
        frequency=np.sqrt(square) / (2.0 * np.pi),
        mass=np.einsum("im,im->m", full, beam.mass @ full),
        slope=full[beam.hub_slope],
        heights=beam.heights,
        shape=full[beam.deflections],
        damping=structure.damping,
    )
