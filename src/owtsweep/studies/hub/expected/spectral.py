"""Computes the expected settled error of SKF in a cell under the true spectrum, without records.

SKF believes in a shaping filter, whose spectrum is near the true one, which has hard edges. Here
the motion has the true spectrum, so the difference of this error from what SKF states of itself
measures the fit.

It is the limit of long records: the start has died away, and nothing depends on the settling time.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.late_errors import find_motion_errors, find_noise_errors
from owtsweep.studies.base.rows import Judgement, Means, make_product_rows
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.known import Known
from owtsweep.studies.hub.known_motion import find_known_motion
from owtsweep.studies.hub.schemes.skf import SCHEME
from owtsweep.studies.hub.spectral_axis import LONGEST_TRANSIENT

if TYPE_CHECKING:
    import pandas as pd

#: The measures whose errors are computed, and each one's parts along x and y.
MEASURES = ("position", "velocity")
AXES = {"position": ("x", "y"), "velocity": ("vx", "vy")}


class SpectralErrors(NamedTuple):
    """The settled mean square errors of SKF along x and y, means over the time between two fixes.

    Attributes
    ----------
    true
        Errors of position (m^2) and velocity ((m/s)^2) under the true spectrum, shape (axes, 2).
    stated
        What SKF's covariance says they are: the solution of the periodic Riccati equation of SKF's
        own model, shape (axes, 2).
    """

    true: Array
    stated: Array


def find_expected_errors(
    config: HubConfig, natural_period: float, amplitude: float
) -> SpectralErrors:
    """Compute the errors of SKF at a natural period (s) and an amplitude (m).

    Raises
    ------
    InputError
        If SKF's filter never settles, because its model has a bias without a walk.
    """
    sensors = sensing.sensors(config.sensors)
    truth = find_known_motion(config, natural_period, amplitude)
    known = Known(sensors, config, natural_period, amplitude)
    axes = SCHEME.own_kernel(known, LONGEST_TRANSIENT).axes
    omega = 2.0 * np.pi * truth.frequency[truth.density > 0.0]
    power = truth.density[truth.density > 0.0] * truth.spacing
    seen = (omega, sensing.force_per_displacement(omega, sensors), sensors.step)
    noise = (
        sensors.force_sigma**2,
        sensors.position_sigma**2,
        sensors.bias_walk**2 * sensors.step,
    )
    true, stated = np.empty((2, 2)), np.empty((2, 2))
    for number, tuned in enumerate(axes):
        model, gains, outputs = tuned.axis.model, tuned.gains, tuned.axis.outputs
        of_motion = find_motion_errors(model, gains, outputs, seen, sensors.fix_scale) @ power
        of_noise = find_noise_errors(model, gains, outputs, noise)
        true[number] = truth.variance[number] * of_motion + of_noise
        settled = gains.covariance[-gains.cycle :]
        stated[number] = np.mean(np.diagonal(settled, axis1=1, axis2=2), axis=0)
    return SpectralErrors(true, stated)


def make_rows(config: HubConfig, periods: Sequence[float], amplitude: float) -> pd.DataFrame:
    """Make the rows of SKF at natural periods (s) and an amplitude (m), in the settled window.

    A row has the expected mean square error of one measure as its value.

    Raises
    ------
    InputError
        As `find_expected_errors`.
    """
    import pandas as pd

    rate = config.sensors.imu.rate
    samples = round(config.record.duration * rate) - round(config.measures.settling_time * rate)
    names = [name for measure in MEASURES for name in (*AXES[measure], measure)]
    windows, counts = ["settled"] * len(names), [samples] * len(names)
    tables = []
    for period in periods:
        true = find_expected_errors(config, period, amplitude).true
        products = np.zeros((len(names), 3))  # the value is the last
        products[:, 2] = np.concatenate([true, true.sum(axis=0, keepdims=True)]).T.ravel()
        judged = [Judgement(Means(names, windows, products, counts))]
        cell = {"natural_period": period, "amplitude": amplitude}
        tables.append(make_product_rows(SCHEME.name, cell, [*cell], [0], judged, apart=False))
    return pd.concat(tables, ignore_index=True)
