"""The knowledge of one direction of a case: models with their errors, sensors, priors of loads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import changed
from owtsweep.structures import Structure
from owtsweep.structures.bernoulli import (
    PlaneBeam,
    assemble_cut,
    assemble_whole,
    strain_matrix,
    stress_matrix,
)
from owtsweep.structures.reduction import Reduced, reduce_free
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contract import DIRECTIONS, Channel, Priors, Setting
from owtsweep.studies.tower.models import INTERFACES
from owtsweep.studies.tower.truth import Motion, damp_whole, find_damping
from owtsweep.studies.tower.tuning import Tuning
from owtsweep.studies.tower.waves import triangular_load

#: With inputs=truth, a load changes at least by this part of the tuning's number per step, because
#: a filter cannot be made for a load without any change.
LEAST = 1e-3


@dataclass(frozen=True)
class Substructure:
    """The model of the substructure between the cuts, one for both directions.

    structure: the whole structure as schemes assume it.
    cut, damping, reduced: the beam between the cuts, its damping matrix, and its reduction.
    strain, stress: Strains and stresses (Pa) of the outer fibre for unit degrees of freedom,
        (nodes, dof).
    wave_shape: as in `Setting`.
    gravity: whether the weight softens the model of the whole structure.
    wholes: Models of the whole structure that were assembled before, by direction and soil factor.
    """

    structure: Structure
    cut: PlaneBeam
    damping: Array
    reduced: Reduced
    strain: Array
    stress: Array
    wave_shape: Array
    gravity: bool
    wholes: dict[tuple[str, float], PlaneBeam] = field(default_factory=dict)

    def assemble_whole(self, direction: str, soil_factor: float) -> PlaneBeam:
        """Assemble the whole structure with the assumed soil, or take it from before."""
        key = direction, soil_factor
        if key not in self.wholes:
            self.wholes[key] = assemble_whole(
                self.structure,
                side=direction == DIRECTIONS[1],
                gravity=self.gravity,
                soil_factor=soil_factor,
            )
        return self.wholes[key]


def misjudge(config: TowerConfig) -> Structure:
    """Return the structure as schemes assume it, with the errors of the section `model`."""
    structure, model = config.structure, config.model
    tubes = [
        changed(
            tube,
            youngs_modulus=tube.youngs_modulus * model.stiffness,
            density=tube.density * model.mass,
        )
        for tube in structure.tubes
    ]
    points = [
        changed(
            point,
            mass=point.mass * model.rotor_mass,
            inertia=point.inertia * model.rotor_mass,
            inertia_side=point.inertia_side and point.inertia_side * model.rotor_mass,
        )
        if point.height >= structure.hub
        else point
        for point in structure.points
    ]
    water = structure.water
    if water is not None:
        water = changed(water, level=water.level + model.water_level)
    damping = structure.damping * model.damping
    return changed(structure, tubes=tubes, points=points, water=water, damping=damping)


def model_substructure(config: TowerConfig) -> Substructure:
    """Model the substructure between the cuts.

    Raise `InputError` if a cut is inside an element, or the model has too many modes.
    """
    structure, (low, high) = misjudge(config), config.heights
    cut = assemble_cut(structure, low, high, gravity=config.model.gravity)
    weightless = assemble_cut(structure, low, high)
    return Substructure(
        structure=structure,
        cut=cut,
        damping=find_damping(structure, weightless),
        reduced=reduce_free(cut, INTERFACES, config.model.modes),
        strain=strain_matrix(structure, cut),
        stress=stress_matrix(structure, cut),
        wave_shape=triangular_load(structure, cut),
        gravity=config.truth.gravity,
    )


def make_setting(
    config: TowerConfig,
    part: Substructure,
    direction: str,
    soil_factor: float,
    channels: Sequence[Channel],
    motion: Motion | None,
) -> Setting:
    """Put together the knowledge of one direction of a case.

    The model of the whole structure has the aerodynamic dampers, and the weight if the truth has
    it. `motion` is read only if the tuning takes numbers from the truth; without it, the declared
    numbers hold.
    """
    whole = part.assemble_whole(direction, soil_factor)
    damper = config.wind.damping if direction == DIRECTIONS[0] else config.wind.side_damping
    inside, damping = damp_whole(whole, part.cut, part.damping, damper * config.model.damping)
    return Setting(
        direction=direction,
        cut=part.cut,
        cut_damping=part.damping,
        reduced=part.reduced,
        whole=whole,
        whole_damping=damping,
        nodes=inside[::2] // 2,
        wave_shape=part.wave_shape,
        strain=part.strain,
        channels=tuple(channels),
        step=1.0 / config.record.rate,
        priors=_make_priors(config.filters, 1.0 / config.record.rate, motion),
        tuning=config.filters,
        rate_noise=config.filters.find_rate_noise(config.waves.hs > 0.0),
        whole_modes=config.model.whole_modes,
    )


def _make_priors(tuning: Tuning, step: float, motion: Motion | None) -> Priors:
    """Return a tuning's priors of the five loads of one direction.

    With declared numbers, a load is a random walk with these steps; as a latent force, it is the
    exponentially correlated process with the tuning's correlation time and, for short times, the
    walk's growth: sigma^2 = step_sigma^2 length / (2 step). `step` is the sampling interval in s.
    """
    change = np.array([tuning.force, tuning.moment] * 2 + [tuning.wave])
    length = np.full(5, tuning.correlation_time)
    if tuning.inputs == "declared" or motion is None:
        return Priors(change, change * np.sqrt(length / (2.0 * step)), length)
    loads = np.column_stack([motion.inputs, motion.wave])
    known = np.isfinite(loads).all(axis=0)  # a record may lack loads: the tuning's numbers hold
    loads = np.where(known, loads, 0.0)
    moving = np.any(loads != 0.0, axis=0)
    seen = np.std(np.diff(loads, axis=0), axis=0)
    size = np.sqrt(np.mean(np.square(loads), axis=0))
    least = LEAST * change
    return Priors(
        step_sigma=np.where(known, np.maximum(seen, least), change),
        sigma=np.where(known, np.maximum(size, least), change * np.sqrt(length / (2.0 * step))),
        length=np.where(moving, _correlate(loads, step), length),
    )


def _correlate(loads: Array, step: float) -> Array:
    """Return the times (s) at which the correlations of the columns have fallen to 1/e."""
    steps = len(loads)
    spectrum = np.abs(np.fft.rfft(loads - loads.mean(axis=0), 2 * steps, axis=0)) ** 2
    correlation = np.fft.irfft(spectrum, axis=0)[:steps]
    fallen = correlation < np.exp(-1.0) * correlation[0]
    return np.asarray(step * np.maximum(np.argmax(fallen, axis=0), 1))
