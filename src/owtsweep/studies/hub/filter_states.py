"""Explains a filter's states: how late the states are, and which acceleration and bias they hold.

`estimates.states` and `estimates.state_chunks` return the states position, velocity, acceleration
and b.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.known import Sensors


def lag_of(chain: Chain) -> int:
    """Return by how many steps the filter's states, smoothed or not, are behind the present.

    `chain` is a scheme in its form for the batch engine.
    """
    return chain.filter.input_delay + chain.filter.window


def has_acceleration(chain: Chain) -> bool:
    """Return whether acceleration is a state that the scheme's filter estimates.

    `chain` is the scheme in its form for the batch engine.
    """
    return bool(np.any(chain.axis.force_row))


def bias_of(state: Array, sensors: Sensors) -> Array:
    """Compute the bias R b^b of the IMU in NED, m/s^2, shape (n, 2), from a filter's states.

    `state` has the shape (n, 4, 2): n steps, four states, x and y. The fourth state is
    x4 = -R b^b + g, Eq. (6) of Ren et al. (2019).
    """
    return np.asarray(np.array(sensors.gravity) - state[:, 3])
