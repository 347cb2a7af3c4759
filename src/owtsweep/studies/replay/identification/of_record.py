"""Estimate noise, delay and clock offset of the recorded sensors in a replay's record.

The IMU's white noise is read from the upper half of its own spectrum, where no hub moves.
The estimates may take the place of what the configuration states.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from threading import Lock

import numpy as np
from scipy.signal import welch

from owtsweep.arrays import Array
from owtsweep.config import changed, with_values
from owtsweep.errors import InputError
from owtsweep.studies.hub.public import Sensors, follow_sensors, make_sensors
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.identification.fit import describe_disagreement, fit_noise
from owtsweep.studies.replay.identification.likelihood import integrate_twice, pose
from owtsweep.studies.replay.loading import Source, load_record, name_source
from owtsweep.studies.replay.measures import TAILS, Measured

#: Positions and IMU samples that are used; of a longer record, the first ones.
MOST_POSITIONS, MOST_STEPS = 2000, 1 << 20
#: Time between the reference's positions that are used, s. A faster reference is thinned.
REFERENCE_STEP = 0.5
#: The least bias walk that is taken as stated, m/s^2/sqrt(s): a logarithm needs one above zero.
LEAST_WALK = 1e-6
#: Units of the parameters.
UNITS = {
    "sensors.imu.sigma": "m/s^2",
    "sensors.gnss.sigma": "m",
    "sensors.imu.bias_walk": "m/s^2/sqrt(s)",
    "sensors.gnss.delay": "s",
    "reference.sigma": "m",
    "clock_offset": "s",
}
#: Samples per spectrum that is averaged, and the least number of these spectra.
SAMPLES, LEAST_SPECTRA = 512, 8
#: Edges of the quarters of the upper half, relative to the Nyquist frequency.
QUARTERS = (0.5, 0.6, 0.7, 0.8, 0.9)
#: Largest deviation of a quarter's level from their mean with which the spectrum counts as flat.
FLAT = 0.15


@dataclass(frozen=True)
class Estimated:
    """One parameter as stated and as estimated from a record.

    parameter, source: a name of `UNITS`, and what the IMU was compared with: "fixes" or
        "reference".
    stated, estimate, low, high: what is stated (NaN: nothing), the estimate and its 95 % interval;
        `low` is 0 (NaN for a time) and `high` NaN where the record sets no bound.
    """

    parameter: str
    source: str
    stated: float
    estimate: float
    low: float
    high: float

    @property
    def inside(self) -> bool:
        """Whether the stated value lies in the interval, or nothing was stated."""
        return not (self.stated < self.low or self.stated > self.high)

    @property
    def bounded(self) -> bool:
        """Whether the record bounds the parameter from both sides."""
        lowest = self.low if UNITS[self.parameter] == "s" else self.low or np.nan
        return bool(np.isfinite(lowest) and np.isfinite(self.high))


@dataclass(frozen=True)
class Noise:
    """What a record says about its sensors.

    parameters: the estimated ones; empty if nothing was recorded or the record is too short.
    heavy_tails: excess kurtosis of the innovations if more than Gaussian noise explains, else 0.
    disagreement: why the specific force and the positions contradict each other; "" if they do not.
    """

    parameters: tuple[Estimated, ...] = ()
    heavy_tails: float = 0.0
    disagreement: str = ""

    def measures(self) -> Iterator[Measured]:
        """Yield the numbers as ("source: parameter", the number's name, value, 1)."""
        for one in self.parameters:
            for name in ("stated", "estimate", "low", "high"):
                if np.isfinite(value := getattr(one, name)):
                    yield (f"{one.source}: {one.parameter}", name, float(value), 1)
        if self.heavy_tails:
            yield (f"innovations: {TAILS}", "estimate", self.heavy_tails, 1)

    @property
    def agrees(self) -> bool:
        """Whether all stated values of sensors lie in their intervals."""
        return all(one.inside for one in self.parameters if one.parameter != "clock_offset")


_LOCK = Lock()


def estimate_noise(config: ReplayConfig, file: str) -> Noise:
    """Estimate the noise of the sensors recorded in a file; the last results stay in memory.

    Nothing is estimated for recorded motion, for fewer than 8 usable positions, nor with
    `replay.noise` "stated".
    Raises InputError if the file cannot be read, or force and positions contradict each other,
        unless `replay.disagreement` is "accept".
    """
    if config.replay.noise == "stated":
        return Noise()
    replay = changed(config.replay, disagreement="accept")
    with _LOCK:  # so that threads do not estimate the same
        noise = _estimate(name_source(config, file, replay))
    if noise.disagreement and config.replay.disagreement == "refuse":
        raise InputError(
            f"{file}: {noise.disagreement}; correct columns, units or sensors.yaw, or insist with "
            "replay.disagreement=accept"
        )
    return noise


@lru_cache(maxsize=256)
def _estimate(key: Source) -> Noise:
    config, record = key.config, load_record(key.config, key.file)
    if record.specific_force is None:
        return Noise()
    sensors = make_sensors(config.sensors)
    parameters: dict[str, Estimated] = {}
    tails, disagreement = 0.0, ""
    sources = [("reference", record.position, max(round(REFERENCE_STEP / record.step), 1))]
    if record.gnss == "recorded":
        sources.append(("fixes", record.fixes, sensors.fix_interval))
    for source, positions, every in sources:
        if positions is None:
            continue
        if source == "reference":
            positions = positions[::every]
        positions = positions[:MOST_POSITIONS]
        steps = min(record.steps, MOST_STEPS, len(positions) * every + 1)
        integral = integrate_twice(record.specific_force[:steps] @ sensors.rotation.T, record.step)
        time = every * record.step * np.arange(len(positions))
        stated = _state(sensors, source)
        start = _choose_start(sensors, stated)
        problem = pose(integral, time, positions, start[3])
        if problem is None:
            continue
        fit = fit_noise(problem, start, measure_floor(record.specific_force[:steps]))
        bounds = np.stack([fit.values, fit.low, fit.high], axis=1)
        bounds[~np.isfinite(bounds)] = np.nan
        for (name, value), row in zip(stated.items(), bounds, strict=True):
            # the reference, which is more exact, was first
            parameters.setdefault(name, Estimated(name, source, value, *map(float, row)))
        disagreement = disagreement or describe_disagreement(problem, start, fit, source)
        if fit.kurtosis > 4.0 * fit.kurtosis_error:
            tails = max(tails, fit.kurtosis)
    ordered = tuple(parameters[name] for name in UNITS if name in parameters)
    return Noise(ordered, tails, disagreement)


def _state(sensors: Sensors, source: str) -> dict[str, float]:
    """Return what is stated of the parameters of a likelihood, in their order; NaN: nothing."""
    sigma, delay = {"reference.sigma": np.nan}, {"clock_offset": 0.0}
    if source == "fixes":
        sigma = {"sensors.gnss.sigma": sensors.position_sigma}
        delay = {"sensors.gnss.delay": sensors.delay * sensors.step}
    force, walk = sensors.force_sigma, sensors.bias_walk
    return {"sensors.imu.sigma": force, **sigma, "sensors.imu.bias_walk": walk, **delay}


def _choose_start(sensors: Sensors, stated: Mapping[str, float]) -> Array:
    force, sigma, walk, delay = stated.values()
    sigma = 0.2 * sensors.position_sigma if np.isnan(sigma) else sigma
    return np.array([force, sigma, max(walk, LEAST_WALK), delay])


def measure_floor(force: Array) -> float:
    """Return the deviation (m/s^2) of white noise with the level of the upper half spectrum.

    `force` are samples (n, 2). NaN if they are few, or the spectrum is not flat there: then it
    holds more than white noise.
    """
    if len(force) < LEAST_SPECTRA * SAMPLES:
        return np.nan
    # a sampling rate of 2 makes the Nyquist frequency 1, and the level the variance
    frequency, power = welch(force, fs=2.0, nperseg=SAMPLES, axis=0)
    edges = np.searchsorted(frequency, QUARTERS)
    levels = np.array([np.mean(part) for part in np.split(power, edges)[1:-1]])
    level = float(np.mean(levels))
    if level <= 0.0 or np.max(np.abs(levels / level - 1.0)) > FLAT:
        return np.nan
    return float(np.sqrt(level))


def use_estimates(config: ReplayConfig, noise: Noise) -> ReplayConfig:
    """Return the configuration with the estimated sensors.

    A parameter bounded from both sides gets its estimate; another keeps a stated value in the
    interval, or gets the nearest end. What `tuning=matched` computes from the sensors is computed
    again.
    """
    sensors, values = config.sensors, dict[str, float]()
    for one in noise.parameters:
        _, _, key = one.parameter.partition("sensors.")
        if key and not one.inside:
            nearest = one.high if one.stated > one.high else one.low
            value = one.estimate if one.bounded else nearest
            size = sensors.deviations if key.endswith(".sigma") else 1.0
            is_delay = key == "gnss.delay"
            values[key] = round_delay(value, sensors.imu.rate) if is_delay else _round(size * value)
    return follow_sensors(config, with_values(sensors, values))


def round_delay(delay: float, rate: float) -> float:
    """Return the delay, s, in whole steps of an IMU of this rate, Hz, that a filter can have."""
    return max(round(delay * rate), 0) / rate


def _round(value: float) -> float:
    return float(np.format_float_scientific(value, precision=2, unique=False))
