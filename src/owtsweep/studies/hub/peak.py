"""Computes the mean square of records that are scaled to a greatest displacement of 1 m.

The mean square of a scaled record is (standard deviation / peak)^2 of the record before scaling.
The mean over records is called the peak factor. To compute it, records are synthesised, but no
scheme is run. It changes slowly with the natural period. So it is computed at fixed periods, the
rungs of a ladder, and interpolated between them: a result does not depend on which other periods a
grid holds.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import as_mapping
from owtsweep.motion.spectra import spectrum
from owtsweep.motion.synthesis import SpectralSource
from owtsweep.streams import stream
from owtsweep.studies.hub.cache import cached
from owtsweep.studies.hub.config import HubConfig

#: Records per rung. All rungs share their phases, so that the factor changes smoothly.
RECORDS = 400
#: Rungs of the ladder per octave of period.
PER_OCTAVE = 2
#: Samples per shortest period of the band: a peak between two samples is at most 0.5 % higher than
#: the samples.
SAMPLES = 32
#: Name of the random stream; no record of a sweep uses it.
STREAM = "phase of a peak factor"


def peak_factors(config: HubConfig, periods: Sequence[float]) -> Array:
    """Compute the mean of (standard deviation / peak)^2 over records, for natural periods (s).

    The result has the shape (periods,). It is interpolated between rungs.
    """
    result = []
    for period in periods:
        rungs = _list_rungs(config, period)
        values = [factor_at(config, rung) for rung in rungs]
        result.append(np.interp(np.log(period), np.log(rungs), values))
    return np.array(result)


def ladder(config: HubConfig, periods: Sequence[float]) -> list[float]:
    """Return the rungs, s, sorted, that `peak_factors` needs for natural periods (s)."""
    return sorted({rung for period in periods for rung in _list_rungs(config, period)})


def _list_rungs(config: HubConfig, period: float) -> list[float]:
    """Return the rungs next to a natural period, s; for a printed spectrum, the period itself."""
    if config.spectrum.kind != "translated":
        return [period]
    rung = np.log2(period) * PER_OCTAVE
    rungs = 2.0 ** (np.array([np.floor(rung), np.floor(rung) + 1.0]) / PER_OCTAVE)
    shortest, longest = 1.0 / config.band[1], 1.0 / config.band[0]
    return [float(end) for end in np.clip(rungs, shortest, longest)]


def factor_at(config: HubConfig, period: float) -> float:
    """Compute the mean of (standard deviation / peak)^2 at one natural period (s), or recall it."""
    what: dict[str, object] = {
        "what": "peak factor",
        "seed": config.seed,
        "duration": config.record.duration,
        "spectrum": as_mapping(config.spectrum),
        "band": list(config.band),
        "period": period,
        "records": RECORDS,
    }
    return float(cached(what, lambda: {"factor": np.array(_mean(config, period))})["factor"])


def _mean(config: HubConfig, period: float) -> float:
    duration = config.record.duration
    steps = int(np.ceil(duration * config.band[1] * SAMPLES))
    shape = spectrum(config.spectrum.kind, period, config.spectrum.bandwidth)
    source = SpectralSource(shape, (config.band[0], config.band[1]))
    total = 0.0
    for record in range(RECORDS):
        phase = stream(config.seed, "hub", (0.0,), record, STREAM)
        position = source.draw_displacement(phase, steps, duration / steps)
        scale = 1.0 / np.max(np.abs(position))
        total += float(np.var(scale * position))
    return total / RECORDS
