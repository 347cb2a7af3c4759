"""Explains a filter's states: how late they are, and what acceleration and bias they contain.

`batch.states` and `batch.state_chunks` return the states position, velocity, acceleration and b.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.contract import Sensors


def lag_of(chain: Chain) -> int:
    """Return by how many steps the filter's (smoothed) states are behind the present."""
    return chain.filter.input_delay + chain.filter.window


def has_acceleration(chain: Chain) -> bool:
    """Return whether acceleration is a state of the chain's model."""
    return bool(np.any(chain.axis.force_row))


def bias_of(state: Array, sensors: Sensors) -> Array:
    """Return the bias R b^b in NED, m/s^2, shape (n, 2), of states of shape (n, 4, 2).

    The fourth state is x4 = -R b^b + g, Eq. (6) of Ren et al. (2019).
    """
    return np.asarray(np.array(sensors.gravity) - state[:, 3])
