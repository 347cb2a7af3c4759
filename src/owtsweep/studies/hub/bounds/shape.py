"""Fits one shaping filter to the motion of a natural period, for the bounds of all amplitudes."""

from __future__ import annotations

import numpy as np

from owtsweep.motion.shaping import ShapingFilter
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.known_motion import find_noise_density, find_spectrum
from owtsweep.studies.hub.shape_cache import fit_or_recall

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
    frequency, density = find_spectrum(config, natural_period, roll_off=roll_off)
    place = np.floor(np.log(frequency / (DENSE_UP_TO * config.band[1])) / APART)
    kept = (place < 0.0) | (np.diff(place, prepend=-1.0) > 0.0)
    noise = find_noise_density(sensing.sensors(config.sensors), frequency[kept])
    return fit_or_recall(frequency[kept], density[kept], STATES, noise / VARIANCE)
