"""Computes the bounds of the mean square error in each cell of natural period and amplitude.

Bound (a) holds for estimators that assume nothing about the motion (`bounds.kalman`). Bound (b)
holds for all linear estimators: even for those that know the motion's spectrum and its variances
along x and y, but not its direction. Both are those of the steady state, in real time: the delay of
the fixes is included, and no later measurement is used. They need no records.

The efficiency of a scheme is the bound divided by the scheme's error. Against (b) it cannot exceed
1 but by chance or because the records of a run are not in the steady state. Against (a) it can: a
scheme whose gains are small shrinks its estimate towards zero. Where the motion is small, it gains
more by following less of the noise than it loses by following less of the motion.
"""

from __future__ import annotations

from itertools import product

import numpy as np
import pandas as pd

from owtsweep.errors import require
from owtsweep.motion.shaping import ShapingFilter
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.bounds.kalman import kalman_bounds
from owtsweep.studies.hub.bounds.known_spectrum import bound_of_known_spectrum
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.known_motion import KnownMotion, find_known_motion, find_noise_density
from owtsweep.studies.hub.spectral_model import fit_or_recall

#: States of the filter. With these the bounds of the default study are within 1 % of those on a
#: window (experiments/better.py).
STATES = 20
#: Variance of motion, m^2, whose floor the fit has. The largest motions see most of the spectrum; a
#: filter that is close for them is close for smaller ones.
VARIANCE = 5.0
#: Above the first number times the band's upper edge, the fit takes frequencies whose distance is
#: at least the second number times the frequency.
DENSE_UP_TO, APART = 1.25, 0.01


def find_shape(config: HubConfig, known: KnownMotion) -> ShapingFilter:
    """Fit the shaping filter of a motion whose spectrum is known, or recall it."""
    frequency, density = known.frequency, known.density
    place = np.floor(np.log(frequency / (DENSE_UP_TO * config.band[1])) / APART)
    kept = (place < 0.0) | (np.diff(place, prepend=-1.0) > 0.0)
    noise = find_noise_density(sensing.sensors(config.sensors), frequency[kept])
    return fit_or_recall(frequency[kept], density[kept], STATES, noise / VARIANCE)


#: The measures that have bounds.
BOUNDED = ("position", "velocity")
#: The columns that say which bound a row has.
CELL = ["natural_period", "amplitude", "measure"]
#: The time window whose errors are compared with bounds: bounds hold in the steady state.
WINDOW = "settled"


def find_bounds(config: HubConfig, natural_period: float, amplitude: float) -> dict[str, float]:
    """Compute bound (b) of one cell: measure -> mean square error, x + y, in m^2 and (m/s)^2.

    natural_period, amplitude: of the motion, s and m.
    Raises InputError as `find_known_motion`, or if the IMU is AC-coupled.
    """
    check_high_pass(config)
    sensors = sensing.sensors(config.sensors)
    known = find_known_motion(config, natural_period, amplitude)
    shape = find_shape(config, known)
    axes = [bound_of_known_spectrum(shape, along, sensors) for along in known.variance if along]
    return dict(zip(BOUNDED, map(sum, zip(*axes, strict=True)), strict=True))


def check_high_pass(config: HubConfig) -> None:
    """Raise InputError if the IMU is AC-coupled, of which bound (b) knows nothing."""
    require(
        config.sensors.imu.high_pass is None,
        "sensors.imu.high_pass: the bound of measures.efficiency leaves out an AC coupling of the "
        "IMU; use sensors.imu.high_pass=null, or measures.efficiency=false",
    )


def compute_bounds(config: HubConfig) -> pd.DataFrame:
    """Compute both bounds of each cell of the configuration's grid.

    One row per cell and measure, with the columns natural_period (s), amplitude (m), measure,
    bound_a and bound_b (m^2 or (m/s)^2). Raises InputError as `find_bounds`.
    """
    assumed_nothing = kalman_bounds(config)
    cells = product(sorted(config.grid.natural_period), sorted(config.grid.amplitude))
    rows = [
        (period, amplitude, measure, assumed_nothing[measure], bound)
        for period, amplitude in cells
        for measure, bound in find_bounds(config, period, amplitude).items()
    ]
    return pd.DataFrame(rows, columns=[*CELL, "bound_a", "bound_b"])


def add_efficiency(summary: pd.DataFrame, config: HubConfig) -> pd.DataFrame:
    """Return a table summary with the columns efficiency_a and efficiency_b at the end.

    They are the bounds divided by the mean; NaN outside the window `settled`, and for measures
    other than position and velocity.
    """
    settled = summary["mean"].where(summary["window"] == WINDOW)
    bounds = compute_bounds(config).set_index(CELL)
    bounds = bounds.reindex(pd.MultiIndex.from_frame(summary[CELL]))
    return summary.assign(
        efficiency_a=bounds["bound_a"].to_numpy() / settled,
        efficiency_b=bounds["bound_b"].to_numpy() / settled,
    )
