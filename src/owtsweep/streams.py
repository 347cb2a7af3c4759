"""Makes named random streams, the only source of randomness in the package."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from zlib import crc32

import numpy as np

__all__ = ["Streams", "stream"]

#: Returns a new random generator of one record, given the name of what is drawn.
Streams = Callable[[str], np.random.Generator]


def stream(
    seed: int, study: str, conditions: Sequence[float | str], replicate: int, name: str
) -> np.random.Generator:
    """Return the random generator of one named quantity of one record.

    Every stream has its own spawn key. Therefore, drawing more numbers from one stream (for a
    longer record or a faster GNSS) changes no other stream. Changing a standard deviation, a delay
    or a setting of a scheme changes no stream at all.

    conditions: Values of those of the record's conditions that must change the random numbers. All
        calls for a study give the same conditions in the same order. Numbers are rounded to a
        millionth.
    replicate: Number of the record among the records with equal conditions.
    name: What is drawn, e.g. "phase" or "imu_x".
    """
    key = (crc32(study.encode()), *map(encode_value, conditions), replicate, crc32(name.encode()))
    return np.random.Generator(np.random.SFC64(np.random.SeedSequence(seed, spawn_key=key)))


def encode_value(value: float | str) -> int:
    """Return a condition's value as a part of a spawn key: an integer that is not negative.

    A number becomes its millionths, modulo 2^64; a text becomes its CRC-32 checksum.
    """
    return crc32(value.encode()) if isinstance(value, str) else round(value * 1e6) % 2**64
