"""The place of a record in the expected best-scheme map, and what is expected of a scheme there."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.motion.spectra import Spectrum, spectrum
from owtsweep.results.superposition import superpose
from owtsweep.studies.hub.public import (
    Chain,
    ErrorSpectrum,
    HubConfig,
    NoiseFloor,
    Scheme,
    Sensors,
    error_spectrum,
    expected_mse,
    make_sensors,
    noise_floor,
    resolve_all,
)
from owtsweep.studies.replay.config import ReplayConfig

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


def find_place(config: ReplayConfig, record: Any) -> Spectrum | None:
    """The fit of Eq. (1) to a record if it has its peak inside the band, else None."""
    shape, (low, high) = read_fit(record), config.fit_band
    return shape if shape is not None and low <= shape.peak_frequency <= high else None


def read_fit(record: Any) -> Spectrum | None:
    """The fit of Eq. (1) to a record, or None; `record` is its line of records.csv."""
    values = [record.get(name, np.nan) for name in "abc"]
    if not np.all(np.isfinite(values)):
        return None
    return Spectrum(*(float(value) for value in values))


def compute_rms_in_band(record: Any) -> float:
    """Root mean square (m) of the displacement inside the frequency band."""
    return float(record["rms"]) * float(np.sqrt(record["band_share"]))


def expect_at_record(config: ReplayConfig, record: Any) -> dict[str, tuple[float, float]] | None:
    """Scheme -> expected settled MSE of position and velocity for the spectrum of the record.

    None if the fit has no peak inside the band.
    """
    shape = find_place(config, record)
    if shape is None:
        return None
    rms = compute_rms_in_band(record)
    return {
        name: expectation.mse(shape.density, config.fit_band, rms)
        for name, expectation in _expect_all(config, record)
    }


def expect_map(
    config: ReplayConfig, record: Any, periods: Array, amplitudes: Array
) -> dict[str, Array]:
    """Scheme -> expected settled MSE by `measures.criterion`, array (periods, amplitudes).

    Motions have the spectrum of the configuration, and the ratio of largest to root mean square
    displacement of the record. Amplitudes are largest displacements.
    """
    band = config.fit_band
    ratio = compute_rms_in_band(record) / float(record["peak"])
    which = 1 if config.measures.criterion == "velocity" else 0
    result: dict[str, Array] = {}
    for name, expectation in _expect_all(config, record):
        floor = expectation.floor.of(("position", "velocity")[which])
        result[name] = np.empty((len(periods), len(amplitudes)))
        for i, period in enumerate(periods):
            shape = spectrum("translated", float(period), config.spectrum.bandwidth)
            unit = expectation.mse(shape.density, band, 1.0)[which] - floor
            result[name][i] = superpose(unit, 0.0, floor, amplitudes * ratio)
    return result


def _expect_all(config: ReplayConfig, record: Any) -> Iterator[tuple[str, Expectation]]:
    """The name and the expectation of each scheme, for the duration of a record."""
    sensors = make_sensors(config.sensors)
    steps = round(float(record["duration"]) / sensors.step)
    for scheme in resolve_all(config.schemes, config):
        yield scheme.name, expect_errors(config, scheme, sensors, steps, config.fit_band)
