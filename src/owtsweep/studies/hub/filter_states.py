"""A filter's states besides position and velocity, and how late they are.

`batch.states` and `batch.state_chunks` give the states (p, v, a, b) themselves.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.contract import Sensors


def lag_of(chain: Chain) -> int:
    """How many steps the filter's states are behind the present."""
    return chain.filter.input_delay + chain.filter.window


def has_acceleration(chain: Chain) -> bool:
    """Whether acceleration is a state of the chain's model."""
    return bool(np.any(chain.axis.force_row))


def bias_of(state: Array, sensors: Sensors) -> Array:
    """R b^b (n, 2), m/s^2, of the states (n, 4, 2): x4 of Eq. (6) is -R b^b + g."""
    return np.asarray(np.array(sensors.gravity) - state[:, 3])
