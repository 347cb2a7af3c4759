"""Loads of waves on the wetted part of a structure, as loads on a beam's degrees of freedom.

Forces per length are those of the hub study's plant (`owtsweep.motion.plant.draw_forces`):
Morison's equation on the structure at rest, with MacCamy and Fuchs' inertia coefficient. They are
spread over the nodes with the work of the elements' shape functions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.motion.lines import Span, sample_periodic
from owtsweep.motion.plant import draw_forces
from owtsweep.streams import Streams
from owtsweep.structures import Structure
from owtsweep.structures.bernoulli import PlaneBeam
from owtsweep.studies.tower.sections import SeaState
from owtsweep.waves import Sea


@dataclass(frozen=True)
class WaveLoads:
    """Wave loads along the direction of the waves.

    `dof`: numbers of the degrees of freedom that are loaded, shape (loaded,). `series`: loads on
    them in N and N m, shape (lead + steps, loaded). `force`: their sum of forces in N, shape (lead
    + steps,).
    """

    dof: NDArray[np.int64]
    series: Array
    force: Array


def make_wave_loads(
    structure: Structure, beam: PlaneBeam, sea: SeaState, draws: Streams, span: Span
) -> WaveLoads:
    """Draw a record of wave loads on a structure in water; the lead is at most as long.

    Raise `InputError` if the record is too short for waves.

    beam: a beam that covers the wetted part of the structure.
    sea: the section `waves`, with a height above 0.
    """
    steps, step, lead = span
    drawn = Sea(sea.hs, sea.tp, sea.gamma)
    heights, forces = draw_forces(structure, drawn, draws("waves"), 2 * steps * step)
    shapes = beam.interpolate(heights)
    dof = np.flatnonzero(np.any(shapes != 0.0, axis=0))

    def sample(lines: NDArray[np.complex128]) -> Array:
        bins = lines * steps
        bins[0] *= 2.0  # the mean has no conjugate twin
        return sample_periodic(bins, steps, lead)

    series = np.stack([sample(shapes[:, i] @ forces) for i in dof], axis=1)
    return WaveLoads(dof, series, sample(forces.sum(axis=0)))


def triangular_load(structure: Structure, beam: PlaneBeam) -> Array:
    """Return the loads on a beam, (dof,), for 1 N/m at sea level that falls to 0 at the ground.

    They are zero without water: the input vector p_2 of Simpson et al. (2025), section 5.4.
    """
    depth = -structure.mudline
    if structure.water is None or depth <= 0.0:
        return np.zeros(len(beam.mass))
    nodes, weights = np.polynomial.legendre.leggauss(4)
    inside = beam.heights[(beam.heights > -depth) & (beam.heights < 0.0)]
    ends = np.array([-depth, *inside, 0.0])
    low, high = ends[:-1, None], ends[1:, None]
    heights = (0.5 * (high - low) * nodes + 0.5 * (high + low)).reshape(-1)
    lengths = (0.5 * (high - low) * weights).reshape(-1)
    return np.asarray((lengths * (1.0 + heights / depth)) @ beam.interpolate(heights))
