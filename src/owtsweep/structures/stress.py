"""Bending stress and strain at the nodes of a beam, from its degrees of freedom."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.structures.bernoulli import NEAR, PlaneBeam
from owtsweep.structures.description import Structure, Tube
from owtsweep.structures.sections import Sections


def moment_matrix(structure: Structure, beam: PlaneBeam) -> Array:
    """Return B with M = B u, the bending moments E I w'' at the nodes in N m, (nodes, 2 nodes).

    At a node between two elements the mean of their moments counts: they differ by inertia loads
    inside the elements only.
    """
    nodes = len(beam.heights)
    below, above = np.zeros((2, nodes, 2 * nodes))
    section = Sections(structure, 0.0)
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
    """Return S with stress = S u: bending stress (Pa) at the outer fibre of each node.

    The shape is (nodes, 2 nodes). Positive is tension where w is negative (upwind, for a load along
    w). Where the wall changes at a node, the weaker section counts.
    """
    return _fibre(structure, beam)[:, None] * moment_matrix(structure, beam)


def strain_matrix(structure: Structure, beam: PlaneBeam) -> Array:
    """Return the strains (no unit) that belong to `stress_matrix`, shape (nodes, 2 nodes)."""
    modulus = np.empty(len(beam.heights))
    for i, height in enumerate(beam.heights):
        modulus[i] = _tube_at(structure, height).youngs_modulus
    return stress_matrix(structure, beam) / modulus[:, None]


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
