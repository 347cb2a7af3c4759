"""The truth of a record: the whole turbine under wind and waves, and what goes through its cuts.

The turbine is a linear beam with soil, rotor-nacelle and aerodynamic dampers at the top. It is not
the servo-aero-elastic model that Simpson et al. (2025) used (section 4): loads of the rotor are
series with declared statistics (`owtsweep.studies.tower.wind`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.lines import Span
from owtsweep.structures import Structure
from owtsweep.structures.bernoulli import PlaneBeam, assemble_cut, assemble_whole
from owtsweep.structures.response import Outputs, respond
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contract import DIRECTIONS
from owtsweep.studies.tower.models import INTERFACES
from owtsweep.studies.tower.waves import WaveLoads, make_wave_loads
from owtsweep.studies.tower.wind import make_top_loads


@dataclass(frozen=True)
class Motion:
    """The truth of one direction of a record.

    displacement, acceleration: Of all degrees of freedom of the cut structure (m, rad; m/s^2,
        rad/s^2), shape (steps, dof).
    inputs: Forces (N) and moments (N m) on the cut structure at its lower and its upper cut, in the
        order of `contract.INPUTS`, shape (steps, 4).
    wave: Load at sea level (N/m) of the triangle, falling to 0 at the ground, with the same
        resultant as the waves, shape (steps,).
    """

    displacement: Array
    acceleration: Array
    inputs: Array
    wave: Array


def make_truth(config: TowerConfig, replicate: int) -> dict[str, Motion]:
    """Simulate the record with a number, of the whole structure in both directions.

    Return direction ("fa", "ss") -> its motion, at the nodes of the estimators' mesh. Raise
    `InputError` if the structure does not stand, a cut is inside an element, or a file of loads
    cannot be used.
    """
    structure, wind, sea = config.structure, config.wind, config.waves
    steps, step, draws = config.record.steps, 1.0 / config.record.rate, config.draws(replicate)
    # Loads act for a while before the record, so that it begins with a motion that has built up.
    lead = steps if wind.file is None else 0
    top = make_top_loads(wind, draws, steps=steps, step=step, lead=lead)
    waves = None
    if sea.hs > 0.0:
        mesh = assemble_whole(structure, **vars(config.truth))
        waves = make_wave_loads(structure, mesh, sea, draws, Span(steps, step, lead))
    yaw = np.deg2rad(sea.yaw)
    shares = (float(np.cos(yaw)), float(np.sin(yaw)))
    return {
        direction: _simulate(
            config, bool(side), top[:, 2 * side : 2 * side + 2], waves, shares[side], lead
        )
        for side, direction in enumerate(DIRECTIONS)
    }


def find_damping(structure: Structure, beam: PlaneBeam) -> Array:
    """Return the damping matrix of a free beam, proportional to its stiffness.

    The structure's damping ratio holds at the first bending mode. (Simpson et al. 2025, section
    5.1, print damping in proportion to mass and stiffness with a ratio for the first mode only. A
    part that goes with the mass would brake rigid motion, so there is none here.)
    """
    from scipy.linalg import eigh

    square = eigh(beam.stiffness, beam.mass, eigvals_only=True, subset_by_index=[2, 2])[0]
    return np.asarray(2.0 * structure.damping / np.sqrt(square) * beam.stiffness)


def damp_whole(whole: PlaneBeam, cut: PlaneBeam, own: Array, damper: float) -> tuple[Array, Array]:
    """Return the degrees of freedom of the whole at the cut's, and the whole's damping matrix.

    `own` is the damping matrix of `cut`, which is a part of `whole`; at the top is a `damper`, in
    N s/m. The shapes are (dof of the cut,) and (dof, dof).
    """
    first = 2 * whole.find_node(cut.heights[0])
    inside = np.asarray(range(first, first + len(cut.mass)))
    damping = np.zeros_like(whole.mass)
    damping[np.ix_(inside, inside)] = own
    damping[-2, -2] += damper
    return inside, damping


def _simulate(
    config: TowerConfig, side: bool, top: Array, waves: WaveLoads | None, share: float, lead: int
) -> Motion:
    """Simulate one direction: loads on the top, and the `share` of the waves that acts along it.

    Loads have the shapes (lead + steps, 2) and (lead + steps, loaded).
    """
    structure, truth = config.structure, config.truth
    whole = assemble_whole(structure, side=side, **vars(truth))
    cut = assemble_cut(structure, *config.heights, **vars(truth))
    size = len(whole.mass)
    weightless = assemble_cut(structure, *config.heights, subdivision=truth.subdivision)
    own_damping = find_damping(structure, weightless)
    damper = config.wind.side_damping if side else config.wind.damping
    inside, damping = damp_whole(whole, cut, own_damping, damper)
    unit = np.eye(size)
    loads, series = unit[:, -2:], top
    if waves is not None:
        loads = np.hstack([loads, share * unit[:, waves.dof]])
        series = np.hstack([top, waves.series])
    free = whole.free
    nodes = inside.reshape(-1, 2)[:: truth.subdivision].reshape(-1)
    pick = unit[nodes]
    none = np.zeros_like(pick)

    def through(matrix: Array) -> Array:
        rows = np.zeros((4, size))
        rows[:, inside] = matrix[INTERFACES]
        return rows

    # What acts on the cut structure from outside is what its motion needs, less the waves.
    wanted = Outputs(
        np.vstack([pick, none, through(cut.stiffness)])[:, free],
        np.vstack([none, none, through(own_damping)])[:, free],
        np.vstack([none, pick, through(cut.mass)])[:, free],
    )
    held = np.ix_(free, free)
    got = respond(
        whole.mass[held], damping[held], whole.stiffness[held], loads[free], series,
        1.0 / config.record.rate, wanted, lead,
    )  # fmt: skip
    series = series[lead:]
    count = len(nodes)
    inputs = got[:, 2 * count :].copy()
    wave: Array = np.zeros(len(series))
    if waves is not None:
        inputs -= series[:, 2:] @ loads[inside[INTERFACES], 2:].T
        wave = share * waves.force[lead:] / (0.5 * -structure.mudline)
    return Motion(got[:, :count].copy(), got[:, count : 2 * count].copy(), inputs, wave)
