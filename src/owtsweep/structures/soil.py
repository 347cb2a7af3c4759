"""The initial stiffness of sand around a pile, by the API's p-y curves.

API RP 2A-WSD, section 6.8: the initial slope of the p-y curve of sand at the depth z is k z, with a
modulus k that a diagram gives over the friction angle (sand below the water table). The diagram is
read here by one of two fits, named in a structure's description:

power
    k = 8085 phi^2.45 - 26.09e6 N/m^3 (16.4, 23.0 and 35.9 MN/m^3 at 33, 35 and 38.5 degrees).
parabola
    k = 197.8e3 phi^2 - 10232e3 phi + 136820e3 N/m^3, as OpenPile reads the diagram (14.6, 21.0 and
    36.1 MN/m^3).

Both hold from 28 to 40 degrees; below 27 degrees the first is negative.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.structures.description import Soil


def initial_modulus(friction_angle: float, fit: str) -> float:
    """Compute the initial modulus of subgrade reaction k of sand, N/m^3.

    `friction_angle` is in degrees; `fit` names a reading of the API's diagram (see the module).
    """
    if fit == "power":
        return 8085.0 * float(friction_angle**2.45) - 26.09e6
    return 197.8e3 * friction_angle**2 - 10232e3 * friction_angle + 136820e3


def stiffness(soil: Soil, depth: Array) -> Array:
    """Compute the stiffness of the soil's springs, N/m per m of pile, at depths in m.

    Depths are below the mudline; above the mudline, where they are negative, there is no soil.
    """
    moduli = np.array([initial_modulus(layer.friction_angle, soil.fit) for layer in soil.layers])
    which = np.searchsorted([layer.bottom for layer in soil.layers], depth)
    k = moduli[np.minimum(which, len(moduli) - 1)]
    return np.where(depth > 0.0, k * depth, 0.0)
