"""Find a record's place in the map of expected errors, and compute the errors expected there."""

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
    """The errors expected of a scheme: `spectrum` per unit of motion, `floor` from sensor noise."""

    spectrum: ErrorSpectrum
    floor: NoiseFloor

    def mse(
        self, density: Callable[[Array], Array], band: tuple[float, float], rms: float
    ) -> tuple[float, float]:
        """Compute the expected MSE of position (m^2) and of velocity ((m/s)^2), x + y.

        Parameters
        ----------
        density
            Function that gives the motion's spectral density S(f), in any unit.
        band
            Lower and upper edge of the spectrum in Hz; outside, the spectrum is zero.
        rms
            Root mean square of the displacement in m.
        """
        position, velocity = expected_mse(self.spectrum, density, band, rms=rms)
        return position + self.floor.of("position"), velocity + self.floor.of("velocity")


def expect_errors(
    config: HubConfig, scheme: Scheme, sensors: Sensors, steps: int, band: tuple[float, float]
) -> Expectation:
    """Compute the errors expected of a scheme, for motions inside a band (Hz).

    `steps` is the length of the record.

    Raises
    ------
    InputError
        If the scheme has no kernel, or its errors do not settle.
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
    """Return the spectrum of Eq. (1) fitted to a record, if its peak is inside the band.

    `record` is the record's row of records.csv. Returns None if there is no fit, or if the peak is
    outside the band.
    """
    shape, (low, high) = read_fit(record), config.fit_band
    return shape if shape is not None and low <= shape.peak_frequency <= high else None


def read_fit(record: Any) -> Spectrum | None:
    """Return the spectrum of Eq. (1) fitted to a record; None if there is no fit.

    `record` is the record's row of records.csv.
    """
    values = [record.get(name, np.nan) for name in "abc"]
    if not np.all(np.isfinite(values)):
        return None
    return Spectrum(*(float(value) for value in values))


def compute_rms_in_band(record: Any) -> float:
    """Compute the root mean square (m) of a record's displacement inside the frequency band.

    `record` is the record's row of records.csv.
    """
    return float(record["rms"]) * float(np.sqrt(record["band_share"]))


def compute_rms_error(config: ReplayConfig, record: Any, shape: Spectrum) -> float:
    """Compute the relative standard error of the rms displacement of records of a sea state.

    That is how far the rms of records of this record's duration scatters around that of the sea
    state: half the relative standard error of the mean square, sqrt(integral of S^2 / duration)
    over the integral of S (Bendat and Piersol, Random Data, section 8.2). The displacement is taken
    as Gaussian.

    Parameters
    ----------
    config
        The configuration; its band holds the spectrum.
    record
        The record's row of records.csv.
    shape
        The spectrum S(f) fitted to the record.
    """
    frequency = np.linspace(*config.fit_band, 4000)
    density = shape.density(frequency)
    total = np.trapezoid(density, frequency)
    square = np.trapezoid(density**2, frequency) / float(record["duration"])
    return float(0.5 * np.sqrt(square) / total)


def expect_at_record(config: ReplayConfig, record: Any) -> dict[str, tuple[float, float]] | None:
    """Compute for each scheme the expected settled MSE of position (m^2) and velocity (m^2/s^2).

    The motion has the spectrum of Eq. (1) fitted to the record, whose row of records.csv is
    `record`. Returns None if the fit has no peak inside the band.
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
    """Compute the map of each scheme's expected settled MSE, shape (periods, amplitudes).

    The measure is `measures.criterion`. The motions have the spectrum kind "translated" with the
    configuration's bandwidth. The ratio of their largest to their rms displacement is that of the
    record.

    Parameters
    ----------
    config
        The configuration of the replay.
    record
        The record's row of records.csv.
    periods
        Natural periods in s.
    amplitudes
        Largest displacements in m.
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
    """Yield each scheme's name and expected errors, for a record of the same duration."""
    sensors = make_sensors(config.sensors)
    steps = round(float(record["duration"]) / sensors.step)
    for scheme in resolve_all(config.schemes, config):
        yield scheme.name, expect_errors(config, scheme, sensors, steps, config.fit_band)
