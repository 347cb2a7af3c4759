"""The place of a record in the expected best-scheme map."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.spectra import Spectrum, spectrum
from owtsweep.results.superposition import superpose
from owtsweep.studies.hub.public import make_sensors, resolve_all
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.expectation import Expectation, expect_errors


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
    shape = read_fit(record)
    band = config.fit_band
    if shape is None or not band[0] <= shape.peak_frequency <= band[1]:
        return None
    rms = compute_rms_in_band(record)
    return {
        name: expectation.mse(shape.density, band, rms)
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
