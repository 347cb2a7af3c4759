"""What an IMU that leans with the tower costs, over the natural period, and what knowing it saves.

The errors are settled means without any record: motion's part by the error spectrum, noise's part
by the noise floor. So they are those of engine=expected in the window "settled".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from owtsweep.config import changed
from owtsweep.motion.spectra import spectrum
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.bounds.kalman import bound_of_axis
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.error_spectrum import (
    error_spectrum,
    expected_mse,
    look_constant,
)
from owtsweep.studies.hub.noise_floor import noise_floor
from owtsweep.studies.hub.resolving import resolve_all
from owtsweep.studies.hub.tuning_rules import FILTERS

if TYPE_CHECKING:
    import pandas as pd

C = TypeVar("C", bound=HubConfig)

#: What the schemes believe of the tilt: name -> factor on the true tilt; None: the IMU is level.
KNOWLEDGE: Mapping[str, float | None] = {
    "level": None,
    "unknown": 0.0,
    "20 % too small": 0.8,
    "20 % too large": 1.2,
    "known": 1.0,
}
#: Largest displacement of a record over its standard deviation, as records of 1000 s have it.
PEAK = 3.5
#: Number of frequencies in the band at which motion's part is computed.
POINTS = 96


def compare_knowledge(
    config: HubConfig, tilt: float, periods: Sequence[float], amplitudes: Sequence[float]
) -> pd.DataFrame:
    """Compute each scheme's settled error for a level IMU, and for what it knows of a tilt.

    Parameters
    ----------
    config
        The configuration of a hub study with one tuning.
    tilt
        Lean of the IMU per displacement, rad/m.
    periods
        Natural periods, s; the motion's spectrum is Eq. (1) of Ren et al. (2019).
    amplitudes
        Largest displacements, m; the standard deviation is 1 / `PEAK` of it.

    Returns
    -------
    DataFrame
        Columns knowledge (see `KNOWLEDGE`), scheme, amplitude, natural_period, mse_position (m^2),
        mse_velocity ((m/s)^2) and bound_position (m^2), the Kalman bound with the tilt known.

    Raises
    ------
    InputError
        If the errors of a scheme do not settle.
    """
    import pandas as pd

    rows = []
    low, high = config.band
    for knowledge, factor in KNOWLEDGE.items():
        sensors = sensing.sensors(config.sensors)
        if factor is not None:
            imu = changed(config.sensors.imu, tilt=tilt)
            sensors = sensing.sensors(changed(config.sensors, imu=imu))
        believing = believe(config, 0.0 if factor is None else factor * tilt)
        frequency = np.geomspace(low, high, POINTS)
        frequency = frequency[~look_constant(frequency * sensors.fix_step)]
        bound = 2.0 * bound_of_axis(sensors)[0]
        for scheme in resolve_all(believing.schemes, believing):
            chain = scheme.kernel(sensors, believing)  # type: ignore[attr-defined]
            errors, noise = error_spectrum(chain, sensors, frequency), noise_floor(chain, sensors)
            band = (float(frequency[0]), float(frequency[-1]))
            for amplitude, period in product(amplitudes, periods):
                shape = spectrum(config.spectrum.kind, period, config.spectrum.bandwidth)
                rms = amplitude / PEAK
                position, velocity = expected_mse(errors, shape.density, band, rms=rms)
                rows.append({
                    "knowledge": knowledge,
                    "scheme": scheme.name,
                    "amplitude": amplitude,
                    "natural_period": period,
                    "mse_position": position + noise.of("position"),
                    "mse_velocity": velocity + noise.of("velocity"),
                    "bound_position": bound,
                })  # fmt: skip
    return pd.DataFrame(rows)


def believe(config: C, tilt: float) -> C:
    """Return the configuration with filters that believe in a tilt, rad/m."""
    filters = {name: changed(getattr(config, name), tilt=tilt) for name in FILTERS}
    return changed(config, **filters)
