"""Compute the lowest modes of vibration of a structure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.structures.beam import assemble
from owtsweep.structures.description import Structure


@dataclass(frozen=True)
class Modes:
    """Modes of vibration, scaled so that the hub moves by 1 m.

    Attributes
    ----------
    frequency
        Natural frequencies in Hz, ascending, shape (modes,).
    mass
        Modal masses in kg, shape (modes,): the kinetic energy is half of it times (velocity of the
        hub in this mode)^2.
    slope
        Rotation of the cross-section at the hub per metre of the hub's displacement, rad/m, shape
        (modes,). Positive: the tower leans the way that the hub moves.
    heights, shape
        Heights in m, shape (nodes,), upwards, and the deflections there, shape (nodes, modes).
    damping
        Damping ratio of every mode.
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
    """Compute the lowest modes of a structure with some blades mounted.

    Parameters
    ----------
    structure
        The structure, checked.
    count
        Number of modes.
    blades
        Number of blades on the hub, 0 to 3.

    Raises
    ------
    InputError
        If the structure has fewer degrees of freedom than modes are wanted, has no blade to mount,
        or buckles under its weight.
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
