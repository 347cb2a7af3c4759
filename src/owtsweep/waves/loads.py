"""Wave loads on a fixed vertical cylinder, per metre of its length (Morison et al. 1950).

The inertia term is MacCamy and Fuchs' (1954), in which waves that are short beside the cylinder are
diffracted: its coefficient is complex and 2 for long waves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.waves.sea import Waves


@dataclass(frozen=True)
class Cylinder:
    """A vertical cylinder at one height in the water.

    Attributes
    ----------
    diameter
        Diameter in m.
    density
        Density of the water in kg/m^3.
    drag
        Coefficient C_D of Morison's equation.
    """

    diameter: float
    density: float = 1025.0
    drag: float = 1.0


def inertia_coefficient(wave_number: Array, diameter: float) -> NDArray[np.complex128]:
    """Compute the complex inertia coefficient C_M of a cylinder in waves, by MacCamy and Fuchs.

    The force per length is C_M rho pi D^2/4 times the complex amplitude of the undisturbed water's
    acceleration at the cylinder's axis, with time as exp(i omega t): C_M = -4 i / (pi (k a)^2
    H_1^(2)'(k a)), a = D/2. C_M is 2 for k a -> 0.

    Parameters
    ----------
    wave_number
        Wave numbers k in rad/m, above 0, shape (lines,).
    diameter
        Diameter D in m.
    """
    from scipy.special import h2vp

    x = np.asarray(wave_number) * diameter / 2.0
    return np.asarray(-4j / (np.pi * x**2 * h2vp(1, x)))


def inertia_force(waves: Waves, cylinder: Cylinder, height: float) -> NDArray[np.complex128]:
    """Compute the complex amplitudes of the inertia force per length, N/m, shape (lines,).

    `height` is in m, between the sea bed and 0.
    """
    mass = cylinder.density * np.pi / 4.0 * cylinder.diameter**2
    coefficient = inertia_coefficient(waves.wave_number, cylinder.diameter)
    return np.asarray(mass * coefficient * waves.acceleration(height))


def drag_force(velocity: Array, cylinder: Cylinder) -> Array:
    """Compute the drag per length, N/m, on a cylinder at rest; `velocity` of the water, m/s."""
    factor = 0.5 * cylinder.density * cylinder.drag * cylinder.diameter
    return np.asarray(factor * velocity * np.abs(velocity))
