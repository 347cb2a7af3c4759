"""Assemble the mass and the stiffness matrix of a structure, by finite elements (scikit-fem).

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
from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.structures.description import Structure
from owtsweep.structures.soil import stiffness

#: Longest element, m.
ELEMENT = 1.0
#: Order up to which polynomials are integrated exactly: two points for shear, three for the rest.
SHEAR_ORDER, ORDER = 3, 5


@dataclass(frozen=True)
class Beam:
    """The matrices of a structure's beam, for the degrees of freedom w, then theta.

    Attributes
    ----------
    stiffness, mass
        Sparse matrices, shape (n, n).
    heights, deflections
        Heights (m) of the nodes of w, upwards, and their degrees of freedom.
    hub_slope
        Degree of freedom of theta at the hub.
    free
        Degrees of freedom that are not clamped.
    """

    stiffness: Any
    mass: Any
    heights: Array
    deflections: Any
    hub_slope: int
    free: Any

    @property
    def hub(self) -> int:
        """The degree of freedom of the deflection of the hub, which is the highest node."""
        return int(self.deflections[-1])


def assemble(structure: Structure, blades: int = 0) -> Beam:
    """Assemble the matrices of a structure with some blades mounted.

    Parameters
    ----------
    structure
        The structure, checked.
    blades
        Number of blades on the hub.
    """
    from scipy.sparse import bmat, lil_matrix
    from skfem import Basis, BilinearForm, ElementLineP1, ElementLineP2, MeshLine

    mesh = MeshLine(_nodes(structure))
    of_w, of_theta = (
        Basis(mesh, element, intorder=ORDER) for element in (ElementLineP2(), ElementLineP1())
    )
    shear_w, shear_theta = (
        Basis(mesh, element, intorder=SHEAR_ORDER) for element in (ElementLineP2(), ElementLineP1())
    )
    bodies = _bodies(structure, blades)

    def form(integrand: Callable[..., Any], *bases: Any) -> Any:
        return BilinearForm(integrand).assemble(*bases)

    section = _Sections(structure, sum(mass for _, mass, _, _ in bodies))
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
    for height, mass, offset, inertia in bodies:
        w = order[np.argmin(np.abs(heights - height))]
        t = of_w.N + int(np.argmin(np.abs(theta_heights - height)))
        bodies_mass[w, w] += mass
        bodies_mass[w, t] += mass * offset
        bodies_mass[t, w] += mass * offset
        bodies_mass[t, t] += mass * offset**2 + inertia
    free = np.arange(of_w.N + of_theta.N)
    if structure.clamped:
        foot = [order[0], of_w.N + int(np.argmin(theta_heights))]
        free = np.setdiff1d(free, foot)
    return Beam(
        stiffness=bmat([[K_ww, K_wt], [K_wt.T, K_tt]]).tocsc(),
        mass=(bmat([[M_ww, None], [None, M_tt]]) + bodies_mass).tocsc(),
        heights=heights,
        deflections=order,
        hub_slope=of_w.N + int(np.argmax(theta_heights)),
        free=free,
    )


def _nodes(structure: Structure) -> Array:
    """Return the heights (m) of the elements' ends: all ends of spans, and points between."""
    ends = [
        np.linspace(low, high, int(np.ceil((high - low) / ELEMENT)) + 1)
        for _, low, high in structure.spans()
    ]
    return np.unique(np.concatenate(ends))


def _bodies(structure: Structure, blades: int) -> list[tuple[float, float, float, float]]:
    """Return height (m), mass (kg), offset (m) and inertia (kg m^2) of the rigid bodies."""
    bodies = [(p.height, p.mass, p.offset, p.inertia) for p in structure.points]
    blade = structure.blade
    if blades and blade is not None:
        factor = blades * blade.flap_factor
        bodies.append((structure.hub, factor * blade.mass, blade.offset, factor * blade.inertia))
    return bodies


class _Sections:
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
            wet = (height < 0.0) & (height > self.structure.mudline)
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
