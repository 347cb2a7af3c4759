"""The true bias of the simulated accelerometer."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub.config import SensorConfig
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.sensors import ForceNoise


def simulate_bias(
    config: SensorConfig,
    sensors: Sensors,
    steps: int,
    stream: Callable[[str], np.random.Generator],
    *,
    piece: int | None = None,
) -> Iterator[Array]:
    """Yield R b^b of a record, (steps, 2) m/s^2 in NED, in pieces.

    Parameters
    ----------
    stream
        Gives the random generator for a name. With the streams of a record's noise, the bias is
        the one in that noise.
    piece
        Steps of a piece; the whole record at once by default.
    """
    biases = ForceNoise(config, sensors, stream).bias
    size = piece or steps
    for begin in range(0, steps, size):
        length = min(size, steps - begin)
        bias = np.stack([axis.draw(length) for axis in biases], axis=1)
        yield np.asarray(bias @ sensors.rotation.T)
