"""The worlds of the hub study, the conditions that a configuration sweeps over, and its maps.

The world motion=spectrum makes its motion from the spectrum of Eq. (1) of Ren et al. (2019), or as
the structure of `plant` moves in one sea.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from operator import attrgetter

from owtsweep.config import Plain, as_mapping
from owtsweep.errors import require
from owtsweep.motion.departing import ModulatedSource, Modulation, PacedSource, PeakSum
from owtsweep.motion.source import Source
from owtsweep.motion.synthesis import SpectralSource, line_numbers
from owtsweep.results.conditions import Value
from owtsweep.results.criteria import MILLIMETRE, MILLIMETRE_PER_SECOND, Criterion
from owtsweep.studies.hub.config import STRUCTURE, HubConfig, MotionConfig
from owtsweep.studies.hub.plant import ONE_SEA, PLANT, check_one_sea, stretch_sea
from owtsweep.studies.hub.world import CONDITIONS, World

#: The order of measures in tables.
MEASURES = ("x", "y", "vx", "vy", "position", "velocity", "nees", "nis")
#: The measures that decide whether two schemes coincide.
CRITERIA = ("position", "velocity")
#: The measures by which schemes may be judged.
JUDGED = {
    "position": Criterion("position: rms error in the plane", "square", "m", *MILLIMETRE),
    "velocity": Criterion(
        "velocity: rms error in the plane", "square", "m/s", *MILLIMETRE_PER_SECOND
    ),
    "x": Criterion("position northwards: rms error", "square", "m", *MILLIMETRE),
    "y": Criterion("position eastwards: rms error", "square", "m", *MILLIMETRE),
}
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
            content |= PLANT.list_content(config)
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


#: Value of the key `motion.kind` -> the world that it chooses.
WORLDS: dict[str, World] = {world.name: world for world in (SpectrumWorld(), PLANT)}


def find_world(config: HubConfig) -> World:
    return WORLDS[config.motion.kind]


def list_departing(config: HubConfig) -> list[str]:
    """Return the keys by which the motion departs from one steady spectrum."""
    keys = ("motion.envelope", "motion.peaks", "motion.pace", "structure")
    return [key for key in keys if attrgetter(key)(config) is not None]


def require_spectrum(config: HubConfig, what: str) -> None:
    """Raise `InputError` unless the motion has one steady spectrum, that of Eq. (1).

    `what` says in words what needs the spectrum.
    """
    world = find_world(config)
    require(
        world.has_spectrum,
        f"motion: {what} needs the spectrum of the motion, which motion={world.name} has not; "
        f"leave out motion={world.name}",
    )
    for key in list_departing(config):
        require(False, f"{key}: {what} needs motion of one steady spectrum; use {key}=null")


def find_amplitude(config: HubConfig, cell: Mapping[str, Value]) -> float | None:
    """Return the amplitude of a cell, m; None: none, motion and noise are run apart.

    It is 1 where no condition is an amplitude: the motion as it is.
    """
    scaled = any(condition.expands for condition in find_world(config).conditions)
    amplitude = cell.get("amplitude", None if scaled else 1.0)
    return None if amplitude is None else float(amplitude)


def list_maps(config: HubConfig) -> dict[str, dict[str, Value]]:
    """List the maps of a run: end of the map's name -> values of the conditions off its axes.

    The end is empty for the first map, and names no condition that has a single value.
    """
    world = find_world(config)
    grid, further = world.get_grid(config), world.find_axes(config)[2:]
    maps: dict[str, dict[str, Value]] = {}
    for values in product(*(grid[name] for name in further)):
        at = dict(zip(further, values, strict=True))
        varied = [f"_{name}_{value}" for name, value in at.items() if len(grid[name]) > 1]
        maps["".join(varied) if maps else ""] = at
    return maps


def criteria(config: HubConfig) -> tuple[str, ...]:
    """Return the measures of best_scheme.csv: position, velocity and the run's criterion."""
    return tuple(dict.fromkeys((*CRITERIA, config.measures.criterion)))


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
