"""Assemble a slender beam in a plane, or the part of one between two cuts (scikit-fem).

Euler-Bernoulli's beam with cubic (Hermite) elements, energies per length, halves left out:

    E I w''^2 - N w'^2 + k_s w^2   and   (rho A + m_w) w_t^2,

where N is the compression by the weight above (left out without gravity), k_s the soil's stiffness
and m_w the added mass of the water. Degrees of freedom are w0, theta0, w1, theta1, ... from the
lowest node upwards, with theta = dw/dz: positive if the structure leans the way it moves.

Bending stress and strain at the nodes follow from the degrees of freedom.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.structures.description import Structure, Tube
from owtsweep.structures.sections import Sections, list_bodies

#: Order up to which polynomials are integrated exactly: tapered walls, and squares of cubics.
ORDER = 10
#: Largest distance from a node that counts as none, m.
NEAR = 1e-6
#: Nodes of which an error tells where no node is.
NEAREST = 5


@dataclass(frozen=True)
class PlaneBeam:
    """The matrices of a beam in a plane.

    `heights`: heights of the nodes above mean sea level in m, upwards, shape (nodes,). `mass`,
    `stiffness`: matrices of w0, theta0, w1, theta1, ... in SI units, shape (2 nodes, 2 nodes).
    `free`: degrees of freedom that are not clamped.
    """

    heights: Array
    mass: Array
    stiffness: Array
    free: NDArray[np.intp]

    def find_node(self, height: float, what: str = "height") -> int:
        """Return the number of the node at a height (m above mean sea level).

        Raise `InputError` if no node is there. The message begins with `what`.
        """
        return find_node(self.heights, height, what, "mean sea level")

    def interpolate(self, height: Array) -> Array:
        """Return H with w(height) = H u, by the elements' shape functions.

        `height` is in m, shape (n,); H has the shape (n, 2 nodes). Its transpose spreads forces at
        these heights over the degrees of freedom with the same work.
        """
        height = np.atleast_1d(height)
        low = np.clip(np.searchsorted(self.heights, height, "right") - 1, 0, len(self.heights) - 2)
        length = self.heights[low + 1] - self.heights[low]
        s = (height - self.heights[low]) / length
        shapes = (
            1.0 - 3.0 * s**2 + 2.0 * s**3,
            length * (s - 2.0 * s**2 + s**3),
            3.0 * s**2 - 2.0 * s**3,
            length * (s**3 - s**2),
        )
        result = np.zeros((len(height), 2 * len(self.heights)))
        for place, shape in enumerate(shapes):
            result[np.arange(len(height)), 2 * low + place] = shape
        return result


def find_node(nodes: Array, height: float, what: str, datum: str = "the ground") -> int:
    """Return which of the nodes is at a height; both are in m above a datum, as `datum` says.

    Raise `InputError` if no node is there. The message begins with `what`.
    """
    nearest = np.argsort(np.abs(nodes - height), kind="stable")[:NEAREST]
    require(
        abs(nodes[nearest[0]] - height) <= NEAR,
        f"{what}: no node of the mesh is {height:g} m above {datum}; the nearest are at "
        f"{', '.join(f'{z:g}' for z in nodes[nearest])} m",
    )
    return int(nearest[0])


def assemble_cut(
    structure: Structure,
    low: float,
    high: float,
    *,
    gravity: bool = False,
    subdivision: int = 1,
) -> PlaneBeam:
    """Assemble the free beam between two cuts, without soil and bodies at its ends.

    Each tube (divided at the mudline and at the sea level) is `subdivision` elements. The cuts are
    in m above mean sea level. With `gravity` the weight above softens the beam. Raise `InputError`
    if a cut is not at the end of a tube, or fewer than two elements lie between the cuts.
    """
    inside = list_nodes(structure, low, high)
    bodies = [
        body for body in list_bodies(structure) if low + NEAR < body[0] < high - NEAR
    ]  # those at the cuts belong to the neighbours
    beam = _assemble(structure, _divide(inside, subdivision), gravity=gravity)
    _add_bodies(beam, bodies, structure.gravity if gravity else 0.0)
    return beam


def list_nodes(structure: Structure, low: float, high: float) -> Array:
    """Return the heights (m above mean sea level) of the nodes from one cut to another.

    Raise `InputError` if a cut is not at the end of a tube, or fewer than two elements lie between
    the cuts.
    """
    ends = np.array(structure.ends())
    for name, cut in (("low", low), ("high", high)):
        require(
            float(np.min(np.abs(ends - cut))) <= NEAR,
            f"cuts: the {name} one at {cut - structure.mudline:g} m above the ground is inside an "
            f"element; cut at {', '.join(f'{end - structure.mudline:g}' for end in ends)}",
        )
    inside = ends[(ends >= low - NEAR) & (ends <= high + NEAR)]
    require(
        len(inside) >= 3,
        f"cuts: {max(len(inside) - 1, 0)} element between {low - structure.mudline:g} and "
        f"{high - structure.mudline:g} m above the ground; a substructure needs 2 or more, so "
        "divide a tube or cut elsewhere",
    )
    return inside


def assemble_whole(
    structure: Structure,
    *,
    side: bool = False,
    gravity: bool = True,
    subdivision: int = 1,
    soil_factor: float = 1.0,
) -> PlaneBeam:
    """Assemble the whole structure, with its soil or foundation and its bodies.

    side: whether motion is across the wind, where bodies have another inertia.
    gravity: whether the weight above softens the beam, and topples bodies above their nodes.
    subdivision: Into how many elements each tube is divided.
    soil_factor: Factor on the stiffness of soil or foundation.
    """
    nodes = _divide(np.array(structure.ends()), subdivision)
    beam = _assemble(structure, nodes, gravity=gravity, soil_factor=soil_factor)
    _add_bodies(beam, list_bodies(structure, side=side), structure.gravity if gravity else 0.0)
    if structure.foundation is not None:
        beam.stiffness[:2, :2] += soil_factor * structure.foundation.matrix()
    if structure.clamped:
        return replace(beam, free=np.arange(2, len(beam.mass)))
    return beam


def _divide(ends: Array, subdivision: int) -> Array:
    """Return `ends` with subdivision - 1 further heights in each interval."""
    steps = np.linspace(0.0, 1.0, subdivision, endpoint=False)
    between = ends[:-1, None] + np.diff(ends)[:, None] * steps
    return np.append(between.reshape(-1), ends[-1])


def _assemble(
    structure: Structure, nodes: Array, *, gravity: bool, soil_factor: float = 0.0
) -> PlaneBeam:
    from skfem import Basis, BilinearForm, ElementLineHermite, MeshLine
    from skfem.helpers import dd

    basis = Basis(MeshLine(nodes), ElementLineHermite(), intorder=ORDER)
    section = Sections(structure)

    def form(integrand: Callable[..., Array]) -> Array:
        return np.asarray(BilinearForm(integrand).assemble(basis).toarray())

    stiffness = form(lambda w, v, p: section.bending(p.x[0]) * dd(w)[0][0] * dd(v)[0][0])
    if gravity:
        stiffness -= form(lambda w, v, p: section.compression(p.x[0]) * w.grad[0] * v.grad[0])
    if soil_factor:
        stiffness += soil_factor * form(lambda w, v, p: section.soil(p.x[0]) * w * v)
    mass = form(lambda w, v, p: section.mass(p.x[0]) * w * v)
    order = basis.nodal_dofs.T.reshape(-1)  # mesh nodes are sorted upwards
    return PlaneBeam(nodes, mass[order][:, order], stiffness[order][:, order], np.arange(len(mass)))


def _add_bodies(
    beam: PlaneBeam, bodies: list[tuple[float, float, float, float]], gravity: float
) -> None:
    """Add rigid bodies to the beam's matrices; their weight above a node topples it."""
    for height, mass, offset, inertia in bodies:
        w = 2 * beam.find_node(height, "structure.points")
        at = np.ix_([w, w + 1], [w, w + 1])
        beam.mass[at] += [[mass, mass * offset], [mass * offset, mass * offset**2 + inertia]]
        beam.stiffness[w + 1, w + 1] -= mass * gravity * offset


def moment_matrix(structure: Structure, beam: PlaneBeam) -> Array:
    """Return B with M = B u, the bending moments E I w'' at the nodes in N m, (nodes, 2 nodes).

    Between two elements the mean of their moments counts: they differ by inertia loads only.
    """
    nodes = len(beam.heights)
    below, above = np.zeros((2, nodes, 2 * nodes))
    section = Sections(structure)
    for i, (low, high) in enumerate(zip(beam.heights[:-1], beam.heights[1:], strict=True)):
        length = high - low
        inside = np.array([low, high]) + NEAR * np.array([1.0, -1.0])  # of this element's tube
        at_low, at_high = section.bending(inside)
        dof = slice(2 * i, 2 * i + 4)
        above[i, dof] = at_low * np.array([-6.0, -4.0 * length, 6.0, -2.0 * length]) / length**2
        below[i + 1, dof] = at_high * np.array([6.0, 2.0 * length, -6.0, 4.0 * length]) / length**2
    result = 0.5 * (below + above)
    result[0], result[-1] = above[0], below[-1]
    return np.asarray(result)


def stress_matrix(structure: Structure, beam: PlaneBeam) -> Array:
    """Return S with stress = S u: bending stress (Pa) at the outer fibre, (nodes, 2 nodes).

    Positive is tension where w is negative (upwind, for a load along w). Where the wall changes at
    a node, the weaker section counts.
    """
    return _fibre(structure, beam)[:, None] * moment_matrix(structure, beam)


def strain_matrix(structure: Structure, beam: PlaneBeam) -> Array:
    """Return the strains (no unit) that belong to `stress_matrix`, shape (nodes, 2 nodes)."""
    modulus = np.array([_tube_at(structure, height).youngs_modulus for height in beam.heights])
    return np.asarray(stress_matrix(structure, beam) / modulus[:, None])


def _fibre(structure: Structure, beam: PlaneBeam) -> Array:
    """Return half the diameter over the second moment of area at the nodes, m^-3."""
    fibre = np.zeros(len(beam.heights))
    for side in (-NEAR, NEAR):
        height = np.clip(beam.heights + side, beam.heights[0] + NEAR, beam.heights[-1] - NEAR)
        for i, z in enumerate(height):
            tube, at = _tube_at(structure, z), np.array([z])
            fibre[i] = max(fibre[i], float(tube.outer(at)[0] / (2.0 * tube.inertia(at)[0])))
    return fibre


def _tube_at(structure: Structure, height: float) -> Tube:
    return next(tube for tube in structure.tubes if tube.bottom <= height <= tube.top)
