"""Find the place of a record in the map of expected errors, and compute expected errors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import lru_cache

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import require
from owtsweep.errors import InputError
from owtsweep.motion.source import Spectrum, translated
from owtsweep.results.superposition import superpose
from owtsweep.studies.hub import public as hub
from owtsweep.studies.replay.config import ReplayConfig

#: Number of frequencies in the band at which an error spectrum is computed.
NODES = 64
#: of `hub.expected_mse`
MEASURES = ("position", "velocity")


@lru_cache(maxsize=8)
def expect_errors(
    chain: hub.Chain, sensors: hub.Sensors, band: tuple[float, float]
) -> tuple[hub.ErrorSpectrum, hub.NoiseFloor]:
    """Compute the errors expected of a scheme's chain for motions inside a band (Hz).

    Returns what motion causes, per unit of motion, at frequencies of the band; and what sensor
        noise causes, whatever the motion.
    """
    nodes = np.geomspace(*band, NODES)
    return hub.error_spectrum(chain, sensors, nodes), hub.noise_floor(chain, sensors)


def check_band(config: ReplayConfig) -> None:
    """Check that expected errors can be computed in the band `replay.band`, if there is one.

    A default band is not checked: where it cannot be used, the record has no place in the map.
    Raises InputError if a frequency is beyond half the IMU's rate, or looks to GNSS like a
        standstill.
    """
    if config.replay.band is None:
        return
    low, high = config.replay.band
    sensors = hub.make_sensors(config.sensors)
    highest = 0.5 / sensors.step
    require(
        high < highest,
        f"replay.band: {high:g} Hz is not below {highest:g} Hz, half of sensors.imu.rate; lower "
        "the upper edge",
    )
    frequencies = np.geomspace(low, high, NODES)
    constant = frequencies[hub.look_constant(frequencies * sensors.fix_step)]
    if len(constant) > 0:
        raise InputError(
            f"replay.band: no expected errors can be computed at {constant[0]:g} Hz, because to "
            f"fixes at {1.0 / sensors.fix_step:g} Hz such a motion looks like a standstill; move "
            f"the edges of the band a little, away from 0 and from multiples of that rate"
        )


def find_place(config: ReplayConfig, record: Mapping[str, float]) -> Spectrum | None:
    """Return the spectrum fitted to a record, if it has one with its peak inside the band."""
    shape, (low, high) = read_fit(record), config.fit_band
    return shape if shape is not None and low <= shape.peak_frequency <= high else None


def read_fit(record: Mapping[str, float]) -> Spectrum | None:
    """Return the spectrum, Eq. (1) of Ren et al. (2019), fitted to a record, if there is one."""
    values = [record[name] for name in "abc"]
    return Spectrum(*values) if np.all(np.isfinite(values)) else None


def compute_rms_in_band(record: Mapping[str, float]) -> float:
    """Compute the rms (m) of the part of a record's displacement inside the band."""
    return record["rms"] * float(np.sqrt(record["band_share"]))


def compute_rms_error(config: ReplayConfig, record: Mapping[str, float], shape: Spectrum) -> float:
    """Compute the relative standard error of the rms displacement of records of a sea state.

    That is half of that of the mean square, sqrt(integral of S^2 / duration) over the integral of
    the fitted spectrum S (Bendat and Piersol, Random Data, section 8.2), for a Gaussian
    displacement.
    """
    frequency = np.linspace(*config.fit_band, 4000)
    density = shape.density(frequency)
    total = np.trapezoid(density, frequency)
    square = np.trapezoid(density**2, frequency) / record["duration"]
    return float(0.5 * np.sqrt(square) / total)


def find_measure(config: ReplayConfig) -> str:
    """Return the measure whose errors are expected: that of the criterion, x and y together."""
    return "velocity" if config.measures.criterion == "velocity" else "position"


def expect_at_record(config: ReplayConfig, record: Mapping[str, float]) -> dict[str, float] | None:
    """Compute the settled errors expected for the spectrum fitted to a record.

    Returns scheme or baseline -> MSE of `find_measure`, m^2 or m^2/s^2; None without a fitted
        spectrum with its peak inside the band.
    Raises InputError if no errors can be computed for one of the schemes.
    """
    shape = find_place(config, record)
    if shape is None:
        return None
    rms, which = compute_rms_in_band(record), MEASURES.index(find_measure(config))
    return {
        name: hub.expected_mse(spectrum, shape.density, config.fit_band, rms=rms)[which] + floor
        for name, spectrum, floor in _expect_all(config, record)
    }


def expect_map(
    config: ReplayConfig, record: Mapping[str, float], periods: Array, amplitudes: Array
) -> dict[str, Array]:
    """Compute the settled MSE expected for motions of many periods (s) and amplitudes (m).

    It is that of `find_measure`, for spectra of the kind "translated" with the configuration's
    bandwidth, whose ratio of largest to rms displacement is that of the record.

    Returns scheme or baseline -> MSE, shape (periods, amplitudes).
    Raises InputError if no errors can be computed for one of the schemes.
    """
    ratio = compute_rms_in_band(record) / record["peak"]
    which = MEASURES.index(find_measure(config))
    shapes = [translated(float(period), config.spectrum.bandwidth).density for period in periods]
    result: dict[str, Array] = {}
    for name, spectrum, floor in _expect_all(config, record):
        units = [hub.expected_mse(spectrum, shape, config.fit_band)[which] for shape in shapes]
        result[name] = superpose(np.array(units)[:, None], 0.0, floor, amplitudes * ratio)
    return result


def list_left_out(config: ReplayConfig) -> list[str]:
    """Return the schemes without a chain, e.g. SKFA: their errors cannot be computed beforehand."""
    return [s.name for s in hub.resolve_all(config.schemes, config) if s.batched != "chain"]


def _expect_all(
    config: ReplayConfig, record: Mapping[str, float]
) -> Iterator[tuple[str, hub.ErrorSpectrum, float]]:
    sensors, left_out = hub.make_sensors(config.sensors), list_left_out(config)
    require(
        len(left_out) < len(config.schemes),
        f"schemes: {', '.join(left_out)}: no expected errors can be computed of a scheme without a "
        "kernel",
    )
    steps = round(record["duration"] / sensors.step)
    baselines = [name for name in hub.BASELINES if name not in config.schemes]
    for scheme in hub.resolve_all([*config.schemes, *baselines], config):
        if scheme.name not in left_out:
            chain = scheme.kernel(hub.Known(sensors, config), steps)
            spectrum, floor = expect_errors(chain, sensors, config.fit_band)
            yield scheme.name, spectrum, floor.of(find_measure(config))
