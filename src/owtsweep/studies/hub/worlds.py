"""The worlds of the hub study: which one a configuration chooses, and how truth may depart from it.

The world motion=spectrum makes its motion from the spectrum of Eq. (1) of Ren et al. (2019), or as
the structure of `plant` moves in one sea.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from itertools import product
from operator import attrgetter

from owtsweep.config import Plain, as_mapping, conf_directory
from owtsweep.config.stored import read
from owtsweep.errors import require
from owtsweep.motion.departing import ModulatedSource, Modulation, PacedSource, PeakSum
from owtsweep.motion.source import Source
from owtsweep.motion.synthesis import SpectralSource, line_numbers
from owtsweep.results.conditions import Value
from owtsweep.studies.base.worlds import Departure, Untold
from owtsweep.studies.hub.config import STRUCTURE, HubConfig, MotionConfig
from owtsweep.studies.hub.plant import ONE_SEA, PLANT, check_one_sea, stretch_sea
from owtsweep.studies.hub.world import CONDITIONS, World

#: Keys of the sensors that change what is measured, while schemes are told the configuration's.
#: Not yaw, gravity and rates: records come to kernels in the frame and at the steps that are told.
OF_SENSORS = (
    "sensors.gnss.sigma", "sensors.gnss.delay", "sensors.gnss.scale", "sensors.gnss.outliers",
    "sensors.gnss.loss", "sensors.gnss.correlation", "sensors.imu.sigma",
    "sensors.imu.bias_initial", "sensors.imu.bias_walk", "sensors.imu.tilt",
    "sensors.imu.high_pass",
)  # fmt: skip
#: Keys of the motion, by the value of `motion.kind`.
OF_MOTION = {
    "spectrum": ("spectrum.bandwidth", "motion.peaks", "motion.pace", "motion.envelope"),
    "plant": ("motion.gamma", "motion.modes", "motion.damping"),
}
#: Slope of the first mode's shape at the hub of the structure ren2019, rad/m.
LEAN = 0.0137
SENSOR_DEPARTURES = {
    "leaning_out": Departure(
        f"the IMU leans the way that it moves, by {LEAN} rad/m", {"sensors.imu.tilt": LEAN}
    ),
    "leaning_back": Departure(
        f"the IMU leans against the way that it moves, by {LEAN} rad/m", {"sensors.imu.tilt": -LEAN}
    ),
    "red_fixes": Departure(
        "red noise of the fixes, .1 m with a time constant of 300 s",
        {"sensors.gnss.correlation.sigma": 0.1, "sensors.gnss.correlation.time": 300.0},
    ),
    "outliers_1": Departure(
        "1 % of the fixes are outliers of 10 standard deviations",
        {"sensors.gnss.outliers.rate": 0.01},
    ),
    "outliers_5": Departure(
        "5 % of the fixes are outliers of 10 standard deviations",
        {"sensors.gnss.outliers.rate": 0.05},
    ),
    "multipath": Departure(
        "5 % of the fixes are outliers, in bursts of 5 with one offset",
        {"sensors.gnss.outliers.rate": 0.05, "sensors.gnss.outliers.length": 5},
    ),
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


def list_untold(config: HubConfig) -> Untold:
    """Return what schemes are not told of truth and measurements."""
    departures = dict(SENSOR_DEPARTURES)
    if config.motion.kind == "spectrum":
        departures |= _list_motions(config.record.duration)
    return Untold((*OF_SENSORS, *OF_MOTION[config.motion.kind]), departures)


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


def _list_motions(duration: float) -> dict[str, Departure]:
    middle = 0.5 * duration
    ends = [max(middle - 150.0, 0.0), min(middle + 150.0, duration)]
    return {
        "two_peaks": Departure(
            "peaks at .1 and .26 Hz share the variance, in place of the natural period's",
            {"motion.peaks": [0.1, 0.26]},
        ),
        "plant_seas": Departure(
            "the structure ren2019 in a sea of hs 2 m and tp 8 s, its time stretched until its "
            "first mode has the cell's natural period, with the cell's amplitude",
            {"structure": _read_structure(), "motion.hs": [2.0], "motion.tp": [8.0]},
        ),
        "drifting_period": Departure(
            "the period falls by 10 % in 300 s in the middle of a record",
            {"motion.pace": [[ends[0], 1.0], [ends[1], 1.0 / 0.9]]},
        ),
    }


@cache
def _read_structure() -> Plain:
    return read(conf_directory() / "structure" / "ren2019.yaml")
