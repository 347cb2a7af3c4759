"""The plant of the hub study: a structure under waves as the source of motion (motion=plant).

The conditions are sea states, mounted blades and the soil's friction angle, instead of natural
period and amplitude. No condition is part of the keys of random streams, so all sea states and
structures have the same phases of the waves and the same noise of the sensors.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from owtsweep import structures, waves
from owtsweep.config import as_mapping, changed
from owtsweep.errors import InputError, require
from owtsweep.motion.plant import HIGHEST, Plant
from owtsweep.results.conditions import Condition, Grid, Value
from owtsweep.structures import Structure
from owtsweep.studies.hub.sections import STRUCTURE, MotionConfig
from owtsweep.sweep.study import add_versions
from owtsweep.waves import Sea

if TYPE_CHECKING:
    from owtsweep.studies.hub.config import HubConfig

#: Packages whose code affects the numbers of the plant alone. Their versions are in the content of
#: the plant's blocks, so that blocks of spectra keep their keys.
ROOMS = (structures, waves)
#: Value of the condition `friction_angle` if the layers keep the angles of the structure's file.
LAYERS = "layers"
HS = Condition("hs", "significant wave height", "m")
TP = Condition("tp", "peak period", "s")
BLADES = Condition("blades", "mounted blades", plural="mounted blades")
FRICTION_ANGLE = Condition("friction_angle", "friction angle", "deg")
#: The conditions of motion=plant.
SEA_CONDITIONS = (HS, TP, BLADES, FRICTION_ANGLE)


def is_plant(config: HubConfig) -> bool:
    """Return whether a structure under waves is the source of motion."""
    return config.motion.kind == "plant"


def require_spectrum(config: HubConfig, what: str) -> None:
    """Raise InputError if the motion has no spectrum of Eq. (1), or grows and falls.

    `what` says in words what needs the spectrum.
    """
    require(
        not is_plant(config),
        f"motion: {what} needs the spectrum of the motion, which motion=plant has not; leave out "
        "motion=plant",
    )
    require(
        config.motion.envelope is None,
        f"motion.envelope: {what} needs motion that neither grows nor falls; use "
        "motion.envelope=null",
    )


def get_sea_grid(motion: MotionConfig) -> Grid:
    """Return name of a condition of the plant -> the values that the configuration gives it."""
    return {
        "hs": motion.hs or [],
        "tp": motion.tp or [],
        "blades": motion.blades or [],
        "friction_angle": [LAYERS] if motion.friction_angle is None else motion.friction_angle,
    }


def make_plant(config: HubConfig, conditions: Mapping[str, Value]) -> Plant:
    """Return the source of motion under some conditions: condition -> value.

    Raises
    ------
    InputError
        If the structure or the sea state cannot be computed; the message names the key.
    """
    motion, structure = config.motion, config.structure
    assert structure is not None  # checked before
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


def describe_content(config: HubConfig) -> dict[str, Any]:
    """Return what a block's numbers depend on, besides the conditions, because of the plant."""
    motion = config.motion
    assert config.structure is not None  # checked before
    return {
        "motion": {name: getattr(motion, name) for name in ("kind", "gamma", "modes", "damping")},
        "structure": as_mapping(config.structure),
        "plant_version": add_versions(0, *ROOMS),
    }


def describe_plant(config: HubConfig) -> str:
    """Return the structure and the waves in words, for titles."""
    structure, motion = config.structure, config.motion
    assert structure is not None  # checked before
    damping = structure.damping if motion.damping is None else motion.damping
    modes = f"{motion.modes} mode{'s' * (motion.modes != 1)}"
    return (
        f"{structure.name} in waves (JONSWAP, γ {motion.gamma:g}), {modes}, damping "
        f"{100.0 * damping:g} %"
    )


def list_breaking(config: HubConfig) -> list[str]:
    """Return in words the sea states that are steeper than waves can be."""
    motion = config.motion
    seas = (Sea(hs, tp, motion.gamma) for tp in motion.tp or [] for hs in motion.hs or [])
    return [f"hs {sea.hs:g} m with tp {sea.tp:g} s" for sea in seas if sea.breaks]


def check_plant(config: HubConfig) -> None:
    """Raise InputError if structure, sea states and sensors do not fit together.

    Without a plant, refuse the keys that only the plant has.
    """
    tilt, motion, structure = config.sensors.imu.tilt, config.motion, config.structure
    if not is_plant(config):
        require(
            tilt != STRUCTURE,
            "sensors.imu.tilt: `structure` needs a structure, but motion=spectrum has none; give "
            "rad/m, or add motion=plant",
        )
        of_plant = [name for name in MotionConfig.model_fields if name != "envelope"]
        for name in of_plant:
            require(
                getattr(motion, name) == getattr(MotionConfig(), name),
                f"motion.{name}: motion=spectrum has neither waves nor structure; add motion=plant",
            )
        require(structure is None, "structure: motion=spectrum has none; add motion=plant")
        return
    require(
        config.engine != "expected",
        "motion: engine=expected, by which `vary` computes, needs the spectrum of the motion, "
        "which motion=plant has not; leave out motion=plant, or simulate records (`sweep` with "
        "engine=batch)",
    )
    require(
        structure is not None,
        "structure: motion=plant needs one; use e.g. structure=ren2019, or structure=FILE.yaml",
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
    for name, values in get_sea_grid(motion).items():
        require(
            len(values) > 0,
            f"motion.{name}: motion=plant needs values; give at least one in a list",
        )
    assert structure is not None
    structure.check()
    _check_structure(config, structure)
    longest = max(motion.tp or [])
    require(
        config.record.duration >= longest,
        f"record.duration: {config.record.duration:g} s is shorter than a wave of {longest:g} s "
        "(motion.tp); lengthen the record",
    )


def _check_structure(config: HubConfig, structure: Structure) -> None:
    """Compute the softest structure's modes, and each sea state, to see whether they exist."""
    motion = config.motion
    require(
        motion.friction_angle is None or structure.soil is not None,
        f"motion.friction_angle: structure {structure.name} stands in no soil; use null",
    )
    softest = {name: values[0] for name, values in get_sea_grid(motion).items()}
    softest["blades"] = max(motion.blades or [])
    if motion.friction_angle is not None:
        softest["friction_angle"] = min(motion.friction_angle)
    for hs in motion.hs or []:
        for tp in motion.tp or []:
            plant = make_plant(config, softest | {"hs": hs, "tp": tp})
    try:
        _ = plant.vibration
    except InputError as error:
        key = str(error).partition(":")[0]
        raise InputError(f"motion.{error}" if key in ("modes", "blades") else str(error)) from error
