"""The expected settled error of a scheme for motion with the spectrum of Eq. (1)."""

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

#: Number of frequencies in the band at which an error spectrum is computed.
NODES = 64


@dataclass(frozen=True)
class Expectation:
    """A scheme's settled error per unit of motion, and its error from sensor noise."""

    spectrum: ErrorSpectrum
    floor: NoiseFloor

    def mse(
        self, density: Callable[[Array], Array], band: tuple[float, float], rms: float
    ) -> tuple[float, float]:
        """Expected MSE of position (m^2) and velocity ((m/s)^2), x + y.

        Parameters
        ----------
        density
            Spectral density S(f) in any unit, zero outside `band` (Hz).
        rms
            Root mean square of the displacement, m.
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
