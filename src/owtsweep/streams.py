"""Named random streams: the only source of randomness in the package."""

from __future__ import annotations

from zlib import crc32

import numpy as np


def stream(
    seed: int, study: str, natural_period: float, replicate: int, name: str
) -> np.random.Generator:
    """The generator of one named quantity of one record.

    Every stream has its own spawn key, so drawing more from one (a longer record, a faster GNSS)
    changes no other, and changing a sigma, a delay or a tuning keeps the noise.

    Parameters
    ----------
    seed
        The run's seed.
    study
        The study's name.
    natural_period
        Natural period of the structure, s; resolved to a microsecond.
    replicate
        Number of the record.
    name
        What is drawn, e.g. "phase" or "imu_x".
    """
    key = (crc32(study.encode()), round(natural_period * 1e6), replicate, crc32(name.encode()))
    return np.random.Generator(np.random.SFC64(np.random.SeedSequence(seed, spawn_key=key)))
