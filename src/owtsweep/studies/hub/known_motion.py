"""Says what there is to know about a motion in advance: its spectrum and its variances.

A record may be scaled to a greatest displacement of 1 m. Its mean square then is (standard
deviation / peak)^2 of the record before scaling; the mean over records is called the peak factor.
To compute it, records are synthesised, but no scheme is run. It changes slowly with the natural
period. So it is computed at fixed periods, the rungs of a ladder, and interpolated between them: a
result does not depend on which other periods a grid holds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import as_mapping
from owtsweep.io.cache import cached
from owtsweep.motion.source import SpectralSource
from owtsweep.streams import stream
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.sensors import Sensors
from owtsweep.studies.hub.worlds import require_spectrum

#: Greatest distance of two frequencies, Hz, and the greatest as a share of the half-bandwidth.
SPACING, SHARE_OF_PEAK = 2e-3, 0.125
#: Frequencies reach from 0 to this multiple of the band's upper edge.
REACH = 4.0
#: Records per rung. All rungs share their phases, so that the factor changes smoothly.
RECORDS = 400
#: Rungs of the ladder per octave of period.
PER_OCTAVE = 2
#: Samples per shortest period of the band: a peak between two samples is at most 0.5 % higher than
#: the samples.
SAMPLES = 32
#: Name of the random stream; no record of a sweep uses it.
STREAM = "phase of a peak factor"


@dataclass(frozen=True)
class KnownMotion:
    """The spectrum of a motion and the variances of its two components.

    frequency: Hz, equally spaced, shape (m,). Each is the middle of an interval; the intervals
        reach from 0 to beyond the band.
    density: mean of the one-sided spectral density of the position in each interval, divided by the
        variance of the position: Hz^-1, shape (m,), with an integral of 1.
    variance: of the position in x and y (north and east), m^2, shape (2,).
    """

    frequency: Array
    density: Array
    variance: Array

    @property
    def spacing(self) -> float:
        """The distance between two frequencies, Hz."""
        return float(self.frequency[1] - self.frequency[0])


def find_known_motion(config: HubConfig, natural_period: float, amplitude: float) -> KnownMotion:
    """Find the spectrum and the variances of the study's motion, without a record of a sweep.

    With normalise=rms the motion's standard deviation is the amplitude. With normalise=peak the
    amplitude is the peak of each record, and the variance is amplitude^2 times the mean of
    (standard deviation / peak)^2 over records that no sweep uses (`peak_factors`). The direction of
    the waves shares the variance out to x and y.

    natural_period, amplitude: of the motion, s and m.
    Raises InputError if the motion is that of a plant, or the printed spectrum lacks the natural
    period.
    """
    frequency, density = _find_spectrum(config, natural_period)
    share = 1.0
    if config.normalise == "peak":
        share = float(peak_factors(config, [natural_period])[0])
    direction = np.deg2rad(config.wave_direction)
    along = amplitude**2 * share
    variance = along * np.array([np.cos(direction), np.sin(direction)]) ** 2
    return KnownMotion(frequency, density, variance)


def _find_spectrum(config: HubConfig, natural_period: float) -> tuple[Array, Array]:
    """Return the frequencies (Hz) and the density (Hz^-1) of `KnownMotion`, shape (m,) each.

    The spectrum is zero outside the configuration's band, as in records.
    """
    require_spectrum(config, "what is known of the motion")
    shape = config.spectrum.at(natural_period)
    first, last = config.band
    half_bandwidth = np.sqrt(shape.peak_frequency * shape.peak_margin)
    spacing = min(SPACING, SHARE_OF_PEAK * half_bandwidth, (last - first) / 32.0)
    edges = spacing * np.arange(np.ceil(REACH * last / spacing) + 1)
    frequency = 0.5 * (edges[1:] + edges[:-1])
    density = shape.density(frequency) * np.diff(np.clip(edges, first, last)) / spacing
    return frequency, density / (np.sum(density) * spacing)


def find_noise_density(sensors: Sensors, frequency: Array) -> Array:
    """Compute the density of position, m^2/Hz (m,), below which the sensors see no motion.

    `frequency` is in Hz, shape (m,). The density is that of the noise of fixes and of the noise of
    the IMU's samples, integrated twice, combined as two measurements of one position. It leaves out
    bias and delay, and what the IMU feels of a tilt. Divided by the variance of the motion along an
    axis, it is the floor of `fit_shaping_filter`.
    """
    fix = 2.0 * sensors.position_sigma**2 * sensors.fix_step
    force = 2.0 * sensors.force_sigma**2 * sensors.step / (2.0 * np.pi * frequency) ** 4
    return np.asarray(1.0 / (1.0 / fix + 1.0 / force))


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
    return float(
        cached(what, lambda: {"factor": np.array(_compute_factor(config, period))})["factor"]
    )


def _compute_factor(config: HubConfig, period: float) -> float:
    duration = config.record.duration
    steps = int(np.ceil(duration * config.band[1] * SAMPLES))
    shape = config.spectrum.at(period)
    source = SpectralSource(shape, (config.band[0], config.band[1]))
    total = 0.0
    for record in range(RECORDS):
        phase = stream(config.seed, "hub", (0.0,), record, STREAM)
        position = source.draw_displacement(phase, steps, duration / steps)
        scale = 1.0 / np.max(np.abs(position))
        total += float(np.var(scale * position))
    return total / RECORDS
