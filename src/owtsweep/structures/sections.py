"""The properties of a structure's cross-sections over the height, and its rigid bodies."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.structures.description import Structure
from owtsweep.structures.soil import stiffness


class Sections:
    """The properties of a structure's cross-sections at heights in m, arrays of any shape."""

    def __init__(self, structure: Structure, bodies_mass: float) -> None:
        self.structure = structure
        self.spans = list(structure.spans())
        self.bodies_mass = bodies_mass
        #: Mass of tubes (kg) between the lower end and heights (m), finely sampled.
        self.sampled = np.unique(
            np.concatenate([np.linspace(low, high, 201) for _, low, high in self.spans])
        )
        middle = 0.5 * (self.sampled[1:] + self.sampled[:-1])
        below = np.cumsum(self._steel(middle) * np.diff(self.sampled))
        self.below = np.concatenate([[0.0], below])

    def _over_tubes(self, value: Callable[[Any, Array], Array], height: Array) -> Array:
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

        def value(tube: Any, z: Array) -> Array:
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

    `blades` is the number of blades on the hub. With `side`, the inertia is that of motion across
    the wind.
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
