"""What a world of the hub study is: one kind of truth, swept over its conditions.

The world motion=spectrum makes its motion from the spectrum of Eq. (1) of Ren et al. (2019).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from operator import attrgetter
from typing import ClassVar

from owtsweep.config import Plain, as_mapping
from owtsweep.errors import require
from owtsweep.motion.departing import ModulatedSource, Modulation, PacedSource, PeakSum
from owtsweep.motion.source import Source
from owtsweep.motion.synthesis import SpectralSource, line_numbers
from owtsweep.results.conditions import Condition, Grid, Value
from owtsweep.studies.hub.config import STRUCTURE, HubConfig, MotionConfig
from owtsweep.studies.hub.seas import LAYERS, ONE_SEA, check_one_sea, list_plant, stretch_sea
from owtsweep.studies.hub.sensors import Sensors


class World(ABC):
    """One kind of truth: a source of motion, and the conditions that it is swept over.

    name: the value of the key `motion` that chooses it.
    conditions, section: the axes of the grid, and the configuration's section with their values.
    has_spectrum: whether the motion has the spectrum of Eq. (1) of Ren et al. (2019).
    bytes_per_step, seconds_per_step: memory and computing time that the motion of a record needs
        per IMU step, besides what schemes need.
    """

    name: ClassVar[str]
    conditions: ClassVar[tuple[Condition, ...]]
    section: ClassVar[str]
    has_spectrum: ClassVar[bool]
    bytes_per_step: ClassVar[int]
    seconds_per_step: ClassVar[float]

    def get_grid(self, config: HubConfig) -> Grid:
        """Return name of a condition -> list of the values that the configuration gives it."""
        section = getattr(config, self.section)
        return {each.name: getattr(section, each.name) or [] for each in self.conditions}

    def order_axes(self, config: HubConfig) -> tuple[Condition, ...]:
        """Return the conditions, with the two first that a map has as axes."""
        return self.conditions

    @abstractmethod
    def check(self, config: HubConfig) -> None:
        """Raise `InputError` if the settings of the motion do not fit together, or the sensors."""

    @abstractmethod
    def list_content(self, config: HubConfig) -> Plain:
        """Return what a block's numbers depend on because of the world, besides the conditions."""

    def list_pairing(self, config: HubConfig) -> Plain:
        """Return what two runs must share so that their records can be paired.

        An envelope changes no phase.
        """
        optional = dict.fromkeys(("motion", "structure", "plant_version", "peaks", "pace"))
        return {**optional, **self.list_content(config), "envelope": None}

    @abstractmethod
    def describe(self, config: HubConfig) -> str:
        """Return in words what is special about the motion; "" for a plain spectrum."""

    @abstractmethod
    def make_source(self, config: HubConfig, conditions: Mapping[str, Value]) -> Source:
        """Return the source of motion under some conditions.

        Raises InputError if it cannot be computed; the message names the key.
        """

    def describe_values(self, at: Mapping[str, Value]) -> str:
        """Return values of conditions in words, e.g. "hs 2 m, blades 0"; "" for no condition.

        What is as the structure's file says is not mentioned.
        """
        named = {condition.name: condition for condition in self.conditions}
        return ", ".join(
            f"{named[name].word} {named[name].show(v)}" for name, v in at.items() if v != LAYERS
        )

    def fit_sensors(self, source: Source, sensors: Sensors, config: HubConfig) -> Sensors:
        """Return what estimators may know of the sensors on this source of motion."""
        return sensors

    def list_doubts(self, config: HubConfig) -> list[str]:
        """Return sentences on what makes the motion doubtful."""
        return []


NATURAL_PERIOD = Condition(
    "natural_period", "natural period", "s", in_streams=True, plural="periods"
)
AMPLITUDE = Condition(
    "amplitude", "motion amplitude", "m", scale="log", enters="scale", plural="amplitudes"
)
#: The conditions of motion=spectrum.
CONDITIONS = (NATURAL_PERIOD, AMPLITUDE)
#: The schemes whose boundary is reported: the first is better at amplitudes below the boundary,
#: the second above.
BOUNDARY = ("HME2", "HME1")
#: Least `Spectrum.peak_margin`, Hz: below it rounding makes the peak infinite.
LEAST_MARGIN = 1e-12


class SpectrumWorld(World):
    """Motion of a given spectrum, multiplied with an amplitude."""

    name = "spectrum"
    conditions = CONDITIONS
    section = "grid"
    has_spectrum = True
    #: Position, velocity and acceleration, eight bytes each.
    bytes_per_step = 24
    seconds_per_step = 0.0

    def check(self, config: HubConfig) -> None:
        _refuse_keys_of_plant(config)
        _check_departures(config)
        _check_band(config)
        _check_spectrum(config)

    def list_content(self, config: HubConfig) -> Plain:
        whole = as_mapping(config)
        content = {key: whole[key] for key in ("spectrum", "normalise", "band")}
        content["envelope"] = config.motion.envelope
        if config.structure is not None:  # else blocks keep their keys
            content |= list_plant(config)
            content["motion"] |= {name: getattr(config.motion, name) for name in ONE_SEA}
        return content | {
            name: value for name in ("peaks", "pace") if (value := getattr(config.motion, name))
        }

    def describe(self, config: HubConfig) -> str:
        motion = config.motion
        parts = []
        if config.structure is not None:
            parts.append(f"{config.structure.name} in waves, its time stretched")
        if motion.peaks:
            parts.append(f"peaks at {' and '.join(f'{peak:g}' for peak in motion.peaks)} Hz")
        for word, points in (("frequency", motion.pace), ("amplitude", motion.envelope)):
            factors = ", ".join(f"{factor:g} at {time:g} s" for time, factor in points or [])
            parts += [f"{word} times {factors}"] if factors else []
        return "; ".join(parts)

    def make_source(self, config: HubConfig, conditions: Mapping[str, Value]) -> Source:
        low, high = config.band
        motion, period = config.motion, float(conditions["natural_period"])
        source: Source
        if config.structure is not None:
            source = stretch_sea(config, period)
        else:
            periods = [period] if motion.peaks is None else [1.0 / peak for peak in motion.peaks]
            shapes = tuple(map(config.spectrum.at, periods))
            shape = shapes[0] if motion.peaks is None else PeakSum(shapes)
            source = SpectralSource(shape, (low, high), config.normalise)
        if motion.pace is not None:
            source = PacedSource(source, Modulation(motion.pace, "motion.pace"), config.normalise)
        if motion.envelope is not None:
            source = ModulatedSource(source, Modulation(motion.envelope))
        return source


def list_departing(config: HubConfig) -> list[str]:
    """Return the keys by which the motion departs from one steady spectrum."""
    keys = ("motion.envelope", "motion.peaks", "motion.pace", "structure")
    return [key for key in keys if attrgetter(key)(config) is not None]


def _refuse_keys_of_plant(config: HubConfig) -> None:
    require(
        config.sensors.imu.tilt != STRUCTURE,
        "sensors.imu.tilt: `structure` needs a structure, but motion=spectrum has none; give "
        "rad/m, or add motion=plant",
    )
    if config.structure is not None:
        check_one_sea(config)
        return
    for name, usual in MotionConfig():
        require(
            name in ("envelope", "peaks", "pace") or getattr(config.motion, name) == usual,
            f"motion.{name}: motion=spectrum has neither waves nor structure; add motion=plant",
        )


def _check_departures(config: HubConfig) -> None:
    """Raise InputError for a motion that is none, or with which no engine can work."""
    motion = config.motion
    for name, points in (("envelope", motion.envelope), ("pace", motion.pace)):
        if points is not None:
            Modulation(points, f"motion.{name}")
    for peak in motion.peaks or []:
        require(
            config.band[0] <= peak <= config.band[1],
            f"motion.peaks: {peak:g} Hz lies outside band [{config.band[0]:g}, "
            f"{config.band[1]:g}] Hz; widen band, or choose another peak",
        )
    for key in list_departing(config):
        require(
            config.engine != "expected",
            f"{key}: engine=expected needs motion of one steady spectrum; use engine=batch",
        )


def _check_band(config: HubConfig) -> None:
    band, imu = config.band, config.sensors.imu
    require(
        band[0] < band[1],
        f"band: the edges [{band[0]:g}, {band[1]:g}] Hz are reversed or equal; use "
        f"band=[{min(band):g},{max(band) if band[0] != band[1] else 2 * band[1]:g}]",
    )
    require(
        band[1] < imu.rate / 2.0,
        f"band: {band[1]:g} Hz is not below the Nyquist frequency {imu.rate / 2.0:g} Hz of the "
        "IMU; lower the upper edge, or raise sensors.imu.rate",
    )
    line_numbers((band[0], band[1]), 2.0 * config.record.duration)


def _check_spectrum(config: HubConfig) -> None:
    for period in config.grid.natural_period:
        of_period = config.spectrum.at(period)
        peak = of_period.peak_frequency
        require(
            of_period.peak_margin > LEAST_MARGIN,
            f"spectrum.bandwidth: {config.spectrum.bandwidth:g} s^-2 leaves the peak at {period:g} "
            "s no width; use e.g. 6.7e-6 (1 % damping)",
        )
        require(
            config.band[0] <= peak <= config.band[1],
            f"grid.natural_period: {period:g} s has its peak at {peak:.3g} Hz, outside band "
            f"[{config.band[0]:g}, {config.band[1]:g}] Hz; widen band, or choose another period",
        )


SPECTRUM = SpectrumWorld()
