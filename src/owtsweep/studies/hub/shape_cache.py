"""Fits shaping filters, and keeps them in the cache folder: a fit takes up to two seconds."""

from __future__ import annotations

from hashlib import blake2b

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.shaping import ShapingFilter, fit_shaping_filter
from owtsweep.studies.hub.cache import cached


def fit_or_recall(frequency: Array, density: Array, states: int, floor: Array) -> ShapingFilter:
    """Return what `fit_shaping_filter` returns for these arguments, from the cache if it is there.

    `frequency` (Hz), `density` and `floor` (Hz^-1) have the shape (m,).

    Raises
    ------
    InputError
        As `fit_shaping_filter`.
    """
    given = b"".join(np.ascontiguousarray(array).tobytes() for array in (frequency, density, floor))
    what = {"what": "shaping filter", "states": states, "given": blake2b(given).hexdigest()}

    def fit() -> dict[str, Array]:
        shape = fit_shaping_filter(frequency, density, states, floor)
        return {name: np.asarray(value) for name, value in vars(shape).items()}

    kept = cached(what, fit)
    return ShapingFilter(
        A=kept["A"],
        B=kept["B"],
        position=kept["position"],
        velocity=kept["velocity"],
        acceleration=kept["acceleration"],
        error=float(kept["error"]),
    )
