"""The accelerometer's bias as it was simulated, which no sensor tells."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

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
    """R b^b of a record, (steps, 2) m/s^2 in NED, in pieces: its noise without all else.

    Parameters
    ----------
    stream
        Name -> generator, as of the record's noise; so the bias is that of the record.
    piece
        Steps of a piece; the whole record at once by default.
    """
    bias_alone = replace(sensors, force_sigma=0.0, gravity=(0.0, 0.0))
    noise = ForceNoise(config, bias_alone, stream)
    size = piece or steps
    for begin in range(0, steps, size):
        yield np.asarray(noise.next(min(size, steps - begin)) @ sensors.rotation.T)
