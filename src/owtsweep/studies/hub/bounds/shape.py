"""Fits one shaping filter to the motion of a natural period, for the bounds of all amplitudes."""

from __future__ import annotations

from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import as_mapping
from owtsweep.motion.shaping import ShapingFilter, fit_shaping_filter
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.expected.cache import cached
from owtsweep.studies.hub.known_motion import find_noise_density, find_spectrum

#: States of the filter. With these the bounds of the default study are within 1 % of those on a
#: window (experiments/better.py).
STATES = 20
#: Variance of motion, m^2, whose floor the fit has. The largest motions see most of the spectrum; a
#: filter that is close for them is close for smaller ones.
VARIANCE = 5.0
#: Above the first number times the band's upper edge, the fit takes frequencies whose distance is
#: at least the second number times the frequency.
DENSE_UP_TO, APART = 1.25, 0.01


def find_shape(
    config: HubConfig, natural_period: float, *, roll_off: bool = False
) -> ShapingFilter:
    """Fit the shaping filter of the study's motion of a natural period (s); cached in a file.

    Parameters
    ----------
    roll_off
        As of `find_known_motion`.

    Raises
    ------
    InputError
        As `find_spectrum`.
    """
    what: dict[str, Any] = {
        "what": "shaping filter of a bound",
        "spectrum": as_mapping(config.spectrum),
        "band": list(config.band),
        "sensors": as_mapping(config.sensors),
        "period": natural_period,
        "roll_off": roll_off,
    }

    def fit() -> dict[str, Array]:
        frequency, density = find_spectrum(config, natural_period, roll_off=roll_off)
        place = np.floor(np.log(frequency / (DENSE_UP_TO * config.band[1])) / APART)
        kept = (place < 0.0) | (np.diff(place, prepend=-1.0) > 0.0)
        noise = find_noise_density(sensing.sensors(config.sensors), frequency[kept])
        shape = fit_shaping_filter(frequency[kept], density[kept], STATES, noise / VARIANCE)
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
