"""The worlds of the hub study: kinds of truth, and how truth may depart from what schemes are told.

The world motion=spectrum makes its motion from the spectrum of Eq. (1) of Ren et al. (2019), or as
a structure moves in one sea. In the world motion=plant a structure moves under waves. The plant's
conditions are sea states, mounted blades and the soil's friction angle. None of them is part of the
keys of random streams, so all sea states and structures have the same phases of the waves and the
same noise of the sensors.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from itertools import product
from operator import attrgetter
from typing import ClassVar

from owtsweep import structures, waves
from owtsweep.config import Plain, as_mapping, changed, conf_directory
from owtsweep.config.stored import read
from owtsweep.errors import InputError, require
from owtsweep.gravity import GRAVITY
from owtsweep.motion.departing import (
    ModulatedSource,
    Modulation,
    PacedSource,
    PeakSum,
    StretchedSource,
)
from owtsweep.motion.plant import HIGHEST, Plant
from owtsweep.motion.source import Source, SpectralSource, line_numbers
from owtsweep.results.conditions import Condition, Grid, Value
from owtsweep.structures import Structure
from owtsweep.studies.base.axes import Axes, Departure, Untold, Values
from owtsweep.studies.hub.config import STRUCTURE, HubConfig, MotionConfig
from owtsweep.studies.hub.sensors import Sensors
from owtsweep.sweep.study import add_versions
from owtsweep.waves import Sea

#: Value of a condition that leaves what the structure's file says.
LAYERS = "layers"


class World(Axes[HubConfig], ABC):
    """One kind of truth: a source of motion, and the conditions that it is swept over.

    name: the value of the key `motion` that chooses it.
    conditions, section: the axes of the grid, and the configuration's section with their values.
    has_spectrum: whether the motion has the spectrum of Eq. (1) of Ren et al. (2019).
    bytes_per_step, seconds_per_step: memory and computing time that the motion of a record needs
        per IMU step, besides what schemes need.
    """

    name: ClassVar[str]
    has_spectrum: ClassVar[bool]
    bytes_per_step: ClassVar[int]
    seconds_per_step: ClassVar[float]

    def get_grid(self, config: HubConfig) -> Grid:
        """Return name of a condition -> list of the values that the configuration gives it."""
        section = getattr(config, self.section)
        return {each.name: getattr(section, each.name) or [] for each in self.conditions}

    def get_values(self, config: HubConfig) -> Values:
        return self.get_grid(config)

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


FRICTION_ANGLE = Condition("friction_angle", "friction angle", "deg")
#: The conditions of the plant, which with motion=spectrum are those of one sea.
ONE_SEA = ("hs", "tp", "blades", "friction_angle")
#: Packages whose code affects the numbers of the plant alone. Their versions are in the content of
#: the plant's blocks, so that blocks of spectra keep their keys.
ROOMS = (structures, waves)


class PlantWorld(World):
    """A structure under waves: the motion has its own size."""

    name = "plant"
    conditions = (
        Condition("hs", "significant wave height", "m"),
        Condition("tp", "peak period", "s"),
        Condition("blades", "mounted blades", plural="mounted blades"),
        FRICTION_ANGLE,
    )
    section = "motion"
    has_spectrum = False
    #: Position, velocity, acceleration, what an IMU feels, and for a while the slope: eight bytes
    #: each.
    bytes_per_step = 40
    #: .1 s for 2000 s at 100 Hz. Schemes share it.
    seconds_per_step = 5e-7

    def get_grid(self, config: HubConfig) -> Grid:
        return {
            **super().get_grid(config),
            "friction_angle": config.motion.friction_angle or [LAYERS],
        }

    def find_axes(self, config: HubConfig) -> list[str]:
        """Return all axes, first those with more than one value, so that a map has them."""
        grid = self.get_grid(config)
        return sorted(self.names, key=lambda name: len(grid[name]) < 2)

    def check(self, config: HubConfig) -> None:
        _check_keys_of_plant(config)
        for name, values in self.get_grid(config).items():
            require(
                len(values) > 0,
                f"motion.{name}: motion=plant needs values; give at least one in a list",
            )
        _check_structure(config)
        longest = max(config.motion.tp or [])
        require(
            config.record.duration >= longest,
            f"record.duration: {config.record.duration:g} s is shorter than a wave of {longest:g} "
            "s (motion.tp); lengthen the record",
        )

    def list_content(self, config: HubConfig) -> Plain:
        motion = config.motion
        names = ("kind", "gamma", "modes", "damping")
        return {
            "motion": {name: getattr(motion, name) for name in names},
            "structure": as_mapping(find_structure(config)),
            "plant_version": add_versions(0, *ROOMS),
        }

    def describe(self, config: HubConfig) -> str:
        structure, motion = find_structure(config), config.motion
        damping = structure.damping if motion.damping is None else motion.damping
        modes = f"{motion.modes} mode{'s' * (motion.modes != 1)}"
        return (
            f"{structure.name} in waves (JONSWAP, γ {motion.gamma:g}), {modes}, damping "
            f"{100.0 * damping:g} %"
        )

    def make_source(self, config: HubConfig, conditions: Mapping[str, Value]) -> Plant:
        motion, structure = config.motion, find_structure(config)
        angle, damping = conditions["friction_angle"], motion.damping
        if angle != LAYERS and structure.soil is not None:
            structure = changed(structure, soil=structure.soil.with_angle(float(angle)))
        if damping is not None:
            structure = changed(structure, damping=damping)
        try:
            sea = Sea(float(conditions["hs"]), float(conditions["tp"]), motion.gamma)
        except InputError as error:
            raise InputError(f"motion.{error}") from error
        return Plant(structure, sea, int(conditions["blades"]), motion.modes)

    def fit_sensors(self, source: Source, sensors: Sensors, config: HubConfig) -> Sensors:
        """Return the sensors; with sensors.imu.tilt=structure, they lean as the first mode does."""
        if config.sensors.imu.tilt != STRUCTURE or not isinstance(source, Plant):
            return sensors
        slope = float(source.vibration.slope[0])
        # estimators multiply the tilt by GRAVITY, whatever the structure's own gravity
        return replace(sensors, tilt=slope * (source.structure.gravity / GRAVITY))

    def list_doubts(self, config: HubConfig) -> list[str]:
        """Return sentences on sea states that are steeper than waves can be."""
        motion = config.motion
        seas = (Sea(hs, tp, motion.gamma) for tp in motion.tp or [] for hs in motion.hs or [])
        return [
            f"motion: hs {sea.hs:g} m with tp {sea.tp:g} s: waves this steep break, so the linear "
            "theory makes them too high"
            for sea in seas
            if sea.breaks
        ]


PLANT = PlantWorld()


def _check_keys_of_plant(config: HubConfig) -> None:
    require(
        config.engine != "expected",
        "motion: engine=expected, by which `vary` computes, needs the spectrum of the motion, "
        "which motion=plant has not; leave out motion=plant, or simulate records (`sweep` with "
        "engine=batch)",
    )
    require(
        config.structure is not None,
        "structure: motion=plant needs one; use e.g. structure=ren2019, or structure=FILE.yaml",
    )
    for name in ("envelope", "peaks", "pace"):
        require(
            getattr(config.motion, name) is None,
            f"motion.{name}: the sea of motion=plant is steady and has its own spectrum; leave out "
            f"motion=plant, or use motion.{name}=null",
        )
    require(
        config.evaluation == "direct",
        "evaluation: the motion of motion=plant has its own size, so there are no amplitudes to "
        "superpose; use evaluation=direct",
    )
    require(
        config.sensors.imu.rate > 2.0 * HIGHEST,
        f"sensors.imu.rate: {config.sensors.imu.rate:g} Hz must be above {2.0 * HIGHEST:g} Hz, "
        f"because the plant moves at up to {HIGHEST:g} Hz",
    )


def _check_structure(config: HubConfig) -> None:
    """Compute the softest structure's modes, and each sea state, to see whether they exist."""
    motion, structure = config.motion, find_structure(config)
    structure.check()
    require(
        motion.friction_angle is None or structure.soil is not None,
        f"motion.friction_angle: structure {structure.name} stands in no soil; use null",
    )
    softest = {name: values[0] for name, values in PLANT.get_grid(config).items()}
    softest["blades"] = max(motion.blades or [])
    if motion.friction_angle is not None:
        softest["friction_angle"] = min(motion.friction_angle)
    for hs in motion.hs or []:
        for tp in motion.tp or []:
            plant = PLANT.make_source(config, softest | {"hs": hs, "tp": tp})
    try:
        _ = plant.vibration
    except InputError as error:
        key = str(error).partition(":")[0]
        raise InputError(f"motion.{error}" if key in ("modes", "blades") else str(error)) from error


def find_structure(config: HubConfig) -> Structure:
    structure = config.structure
    assert structure is not None  # checked before
    return structure


def stretch_sea(config: HubConfig, period: float) -> StretchedSource:
    """Return the motion of the structure in its one sea, slowed until its first mode has a period.

    `period` is in s. Its size is set as that of a spectrum's motion.
    """
    usual: Mapping[str, list[Value]] = {"blades": [0], "friction_angle": [LAYERS]}
    conditions = {name: (getattr(config.motion, name) or usual[name])[0] for name in ONE_SEA}
    plant = PLANT.make_source(config, conditions)
    stretch = period * float(plant.vibration.frequency[0])
    return StretchedSource(plant, stretch, config.normalise)


def check_one_sea(config: HubConfig) -> None:
    """Raise `InputError` unless the structure can move in one sea in place of a spectrum."""
    motion = config.motion
    for name in ONE_SEA:
        values = getattr(motion, name) or []
        needed = name in ("hs", "tp")
        require(
            len(values) == 1 or (not needed and not values),
            f"motion.{name}: it has {len(values)} values, and with motion=spectrum the structure "
            "moves in one sea; give one, or add motion=plant",
        )
    require(
        motion.peaks is None,
        "motion.peaks: the structure moves in place of a spectrum; leave one of them out",
    )
    find_structure(config).check()
    stretch_sea(config, 1.0)


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


def list_content(config: HubConfig) -> Plain:
    """Return the settings on which every block depends, without grid and tuning."""
    whole = as_mapping(config)
    content = {key: whole[key] for key in ("seed", "engine", "record", "wave_direction", "sensors")}
    content |= find_world(config).list_content(config)
    content["settling_time"] = config.measures.settling_time
    content["extremes"] = config.measures.extremes
    return content


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


def list_untold(config: HubConfig) -> Untold:
    """Return what schemes are not told of truth and measurements."""
    departures = dict(SENSOR_DEPARTURES)
    if config.motion.kind == "spectrum":
        departures |= _list_motions(config.record.duration)
    return Untold((*OF_SENSORS, *OF_MOTION[config.motion.kind]), departures)


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
