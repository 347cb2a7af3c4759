"""The plant of the hub study: a structure under waves as the source of motion (motion=plant).

The conditions are sea states, mounted blades and the soil's friction angle, instead of natural
period and amplitude. No condition is part of the keys of random streams, so all sea states and
structures have the same phases of the waves and the same noise of the sensors.

With motion=spectrum, the structure may move in one sea in place of a spectrum.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from owtsweep import structures, waves
from owtsweep.config import Plain, as_mapping, changed
from owtsweep.errors import InputError, require
from owtsweep.gravity import GRAVITY
from owtsweep.motion.departing import StretchedSource
from owtsweep.motion.plant import HIGHEST, Plant
from owtsweep.motion.source import Source
from owtsweep.results.conditions import Condition, Grid, Value
from owtsweep.structures import Structure
from owtsweep.studies.hub.config import STRUCTURE, HubConfig
from owtsweep.studies.hub.sensors import Sensors
from owtsweep.studies.hub.world import LAYERS, World
from owtsweep.sweep.study import add_versions
from owtsweep.waves import Sea

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
        _check_keys(config)
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


def _check_keys(config: HubConfig) -> None:
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
