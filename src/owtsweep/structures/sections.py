"""The properties of a structure's cross-sections over the height, its rigid bodies and its soil.

The soil is the initial stiffness of sand around a pile, by the API's p-y curves: API RP 2A-WSD,
section 6.8. The initial slope of the p-y curve of sand at the depth z is k z, with a modulus k that
a diagram gives over the friction angle (sand below the water table). The diagram is read here by
one of two fits, named in a structure's description:

power
    k = 8085 phi^2.45 - 26.09e6 N/m^3 (16.4, 23.0 and 35.9 MN/m^3 at 33, 35 and 38.5 degrees).
parabola
    k = 197.8e3 phi^2 - 10232e3 phi + 136820e3 N/m^3, as OpenPile reads the diagram (14.6, 21.0 and
    36.1 MN/m^3).

Both hold from 28 to 40 degrees; below 27 degrees the first is negative.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from owtsweep.arrays import Array
from owtsweep.structures.description import Soil, Structure, Tube


class Sections:
    """The properties of a structure's cross-sections at heights in m, arrays of any shape.

    The weight is that of the structure with some `blades` on the hub.
    """

    def __init__(self, structure: Structure, blades: int = 0) -> None:
        self.structure = structure
        self.bodies_mass = sum(mass for _, mass, _, _ in list_bodies(structure, blades))
        #: Mass of tubes (kg) between the lower end and heights (m), finely sampled.
        self.sampled = np.unique(
            np.concatenate([np.linspace(*ends, 201) for ends in pairwise(structure.ends())])
        )
        middle = 0.5 * (self.sampled[1:] + self.sampled[:-1])
        below = np.cumsum(self._steel(middle) * np.diff(self.sampled))
        self.below = np.concatenate([[0.0], below])

    def _over_tubes(self, value: Callable[[Tube, Array], Array], height: Array) -> Array:
        result = np.zeros_like(height)
        for tube in self.structure.tubes:
            inside = (height >= tube.bottom) & (height <= tube.top)
            result[inside] = value(tube, height[inside])
        return result

    def _steel(self, height: Array) -> Array:
        return self._over_tubes(lambda tube, z: tube.density * tube.area(z), height)

    def bending(self, height: Array) -> Array:
        """Compute E I, N m^2."""
        return self._over_tubes(lambda tube, z: tube.youngs_modulus * tube.inertia(z), height)

    def shear(self, height: Array) -> Array:
        """Compute kappa G A, N; kappa = 2 (1 + nu) / (4 + 3 nu) of a thin tube (Cowper 1966)."""

        def value(tube: Tube, z: Array) -> Array:
            nu = tube.poissons_ratio
            kappa = 2.0 * (1.0 + nu) / (4.0 + 3.0 * nu)
            return np.asarray(kappa * tube.youngs_modulus / (2.0 * (1.0 + nu)) * tube.area(z))

        return self._over_tubes(value, height)

    def rotary(self, height: Array) -> Array:
        """Compute rho I, kg m."""
        return self._over_tubes(lambda tube, z: tube.density * tube.inertia(z), height)

    def mass(self, height: Array) -> Array:
        """Compute the mass per length with the water's added mass, kg/m."""
        total = self._steel(height)
        water = self.structure.water
        if water is not None:
            wet = (height < water.level) & (height > self.structure.mudline)
            area = self._over_tubes(lambda tube, z: np.pi / 4.0 * tube.outer(z) ** 2, height)
            total = total + np.where(wet, water.added_mass * water.density * area, 0.0)
        return total

    def soil(self, height: Array) -> Array:
        """Compute the soil's stiffness, N/m per m."""
        soil = self.structure.soil
        if soil is None:
            return np.zeros_like(height)
        return stiffness(soil, self.structure.mudline - height)

    def compression(self, height: Array) -> Array:
        """Compute the compression by the weight above, N, positive under weight."""
        above = self.below[-1] - np.interp(height, self.sampled, self.below)
        return np.asarray(self.structure.gravity * (above + self.bodies_mass))


def list_bodies(
    structure: Structure, blades: int = 0, *, side: bool = False
) -> list[tuple[float, float, float, float]]:
    """Return height (m), mass (kg), offset (m) and inertia (kg m^2) of the rigid bodies.

    `blades` is the number of blades on the hub; `side` means motion across the wind.
    """
    bodies = [
        (p.height, p.mass, p.offset, p.inertia_side if side and p.inertia_side else p.inertia)
        for p in structure.points
    ]
    blade = structure.blade
    if blades and blade is not None:
        factor = blades * blade.flap_factor
        bodies.append((structure.hub, factor * blade.mass, blade.offset, factor * blade.inertia))
    return bodies


def initial_modulus(friction_angle: float, fit: str) -> float:
    """Compute the initial modulus of subgrade reaction k of sand, N/m^3; the angle is in degrees.

    `fit` names a reading of the API's diagram (see the module).
    """
    if fit == "power":
        return 8085.0 * float(friction_angle**2.45) - 26.09e6
    return 197.8e3 * friction_angle**2 - 10232e3 * friction_angle + 136820e3


def stiffness(soil: Soil, depth: Array) -> Array:
    """Compute the stiffness of the soil's springs, N/m per m of pile, at depths in m.

    Above the mudline, at negative depths, there is no soil.
    """
    moduli = np.array([initial_modulus(layer.friction_angle, soil.fit) for layer in soil.layers])
    which = np.searchsorted([layer.bottom for layer in soil.layers], depth)
    k = moduli[np.minimum(which, len(moduli) - 1)]
    return np.where(depth > 0.0, k * depth, 0.0)
