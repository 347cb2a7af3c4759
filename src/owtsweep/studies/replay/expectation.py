"""The settled error that is expected of a scheme for a motion of Eq. (1), without any record."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.studies.hub.public import (
    Chain,
    ErrorSpectrum,
    HubConfig,
    NoiseFloor,
    Scheme,
    Sensors,
    error_spectrum,
    expected_mse,
    noise_floor,
)

#: Frequencies at which an error spectrum is computed over the band.
NODES = 64


@dataclass(frozen=True)
class Expectation:
    """A scheme's settled error per unit of motion, and the error that its sensors' noise makes."""

    spectrum: ErrorSpectrum
    floor: NoiseFloor

    def mse(
        self, density: Callable[[Array], Array], band: tuple[float, float], rms: float
    ) -> tuple[float, float]:
        """Expected MSE of position (m^2) and velocity ((m/s)^2), x + y.

        Parameters
        ----------
        density
            S(f) in any unit, cut off at the edges of `band` (Hz).
        rms
            Of the displacement, m.
        """
        position, velocity = expected_mse(self.spectrum, density, band, rms=rms)
        return position + self.floor.of("position"), velocity + self.floor.of("velocity")


def expect_errors(
    config: HubConfig, scheme: Scheme, sensors: Sensors, steps: int, band: tuple[float, float]
) -> Expectation:
    """The expectation of a scheme under a configuration, for motions inside a band (Hz).

    Raises
    ------
    InputError
        If the scheme has no kernel, or does not settle.
    """
    kernel: Any = getattr(scheme, "kernel", None)
    if kernel is None:
        raise InputError(f"schemes: {scheme.name} has no kernel, so nothing can be expected of it")
    chain = kernel(sensors, config, steps)
    return _compute(chain, sensors, *band)


@lru_cache(maxsize=8)
def _compute(chain: Chain, sensors: Sensors, low: float, high: float) -> Expectation:
    frequencies = np.geomspace(low, high, NODES)
    return Expectation(error_spectrum(chain, sensors, frequencies), noise_floor(chain, sensors))
