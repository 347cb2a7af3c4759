"""Makes the models and gains of SKF along x and y from what is known of the motion.

The shaping filters that are fitted to a spectrum are kept in memory.
"""

from __future__ import annotations

from hashlib import blake2b
from threading import local

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.shaping import ShapingFilter, fit_shaping_filter
from owtsweep.studies.hub.cache import cached
from owtsweep.studies.hub.known import Sensors
from owtsweep.studies.hub.known_motion import KnownMotion, find_noise_density
from owtsweep.studies.hub.scheme_sections import Skf
from owtsweep.studies.hub.spectral_axis import SpectralAxis, TunedAxis, make_axis, tune_axis

#: Least share of an axis in the variance of the motion. An axis without any motion would have a
#: covariance of zero, which cannot be inverted; so little is far below the error of an estimate.
LEAST_SHARE = 1e-6
#: Density at which the fit of the shaping filter still matters, as a share of what the sensors'
#: noise has as a position: the filter sees more than a single sample does. With a tenth, what SKF
#: states of its error is nearest to the truth.
FLOOR = 0.1


class _Last(local):
    """What a thread tuned last, which it often needs again: the gains take some 0.4 s.

    More is not kept, because the gains along x and y take 80 MB for records of 2000 s.
    """

    what: tuple[object, ...] | None = None
    axes: tuple[TunedAxis, TunedAxis]


_LAST = _Last()


def make_axes(
    known: KnownMotion, tuning: Skf, sensors: Sensors
) -> tuple[SpectralAxis, SpectralAxis]:
    """Make the models along x and y: one shaping filter, and the variance of each axis.

    The shaping filter is fitted where the motion's density is above what the sensors' noise has as
    a position. The floor is that of the axis with the larger variance.
    """
    variance = np.maximum(known.variance, LEAST_SHARE * np.sum(known.variance))
    floor = FLOOR * find_noise_density(sensors, known.frequency) / np.max(variance)
    shaping = fit_or_recall(known.frequency, known.density, tuning.states, floor)
    x, y = (make_axis(shaping, float(one), tuning, sensors) for one in variance)
    return x, y


def tune_axes(
    known: KnownMotion, tuning: Skf, sensors: Sensors, steps: int
) -> tuple[TunedAxis, TunedAxis]:
    """Make the models along x and y with their gains, for records of up to `steps` IMU steps."""
    told = (known.frequency, known.density, known.variance)
    what = (*(array.tobytes() for array in told), repr(tuning), sensors, steps)
    if _LAST.what != what:
        x, y = make_axes(known, tuning, sensors)
        _LAST.what = None
        _LAST.axes = tune_axis(x, steps), tune_axis(y, steps)
        _LAST.what = what
    return _LAST.axes


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
