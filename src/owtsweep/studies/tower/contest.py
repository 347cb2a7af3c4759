"""What is the tower study's own in the contest of its schemes: axes, criteria, a run in words."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd

from owtsweep.gravity import GRAVITY
from owtsweep.motion.recorded import tell_alone
from owtsweep.results.conditions import Condition
from owtsweep.studies.base.contest import Contest, Costs
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contract import INPUTS, Kind
from owtsweep.studies.tower.measures import CRITERIA, QUIETEST
from owtsweep.studies.tower.models import model_cut
from owtsweep.studies.tower.schemes.filtered import observe
from owtsweep.studies.tower.sight import LEAN, SHIFT, find_missed, set_up

#: The axes of the grid.
CONDITIONS = (
    Condition(
        "soil_factor",
        "soil stiffness of the model over the true one",
        scale="log",
        enters="knowledge",
    ),
    Condition("noise", "sensor noise", "%", scale="log", plural="noises", enters="sensors"),
)
#: Keys of the section `model` that are factors.
FACTORS = ("stiffness", "mass", "damping", "rotor_mass")
#: Keys of the section `faults` -> what is said of a fault.
FAULTS = {
    "bias": "bias {:g} of sigma",
    "drift": "drift {:g} of sigma",
    "loss": "loss {:g}",
    "tilted_accelerometers": "accelerometers feel tilt",
    "accelerated_inclinometers": "inclinometers feel acceleration",
}
#: Measures of the smallest noise -> whose it is, its unit, and the size of the unit in SI.
NOISES = {
    QUIETEST["theta"]: ("inclinometer", "microrad", 1e-6),
    QUIETEST["a"]: ("accelerometer", "micro-g", 1e-6 * GRAVITY),
}
#: What no sensor sees, and the kind of sensor that would -> what is said of it.
UNSEEN: dict[tuple[str, Kind], str] = {
    (SHIFT, "x"): "Position and velocity of the rigid translation are unseen (one Jordan block at "
    "the eigenvalue 1), because no sensor feels where the structure stands or a constant velocity: "
    "displacements drift, bending does not. A displacement sensor or a GNSS receiver stops the "
    "drift.",
    (LEAN, "theta"): "Angle and angular velocity of the rigid rotation are unseen, because no "
    "sensor tells a constant lean apart. An inclinometer does.",
}


def describe_truth(config: TowerConfig) -> str:
    """Return structure, loads or recorded motion, and length of the records in words."""
    if config.recorded.file is not None:
        motion = tell_alone(config.recorded.file)
        return f"{config.structure.name}, {motion}, {config.record.duration:g} s"
    sea = config.waves
    waves = f"waves Hs {sea.hs:g} m, Tp {sea.tp:g} s, yaw {sea.yaw:g}°" if sea.hs else "no waves"
    wind = f"loads of {config.wind.file}" if config.wind.file else f"wind {config.wind.speed:g} m/s"
    gravity = "" if config.truth.gravity else ", without gravity"
    return f"{config.structure.name}, {wind}, {waves}{gravity}, {config.record.duration:g} s"


def describe_sensors(config: TowerConfig) -> str:
    """Return the set-up of sensors, and what is wrong with sensors and model."""
    wrong = describe_errors(config)
    return f"{config.sensors.name}{f'; wrong: {wrong}' if wrong else ''}"


def describe_errors(config: TowerConfig) -> str:
    """Return what is wrong with the schemes' model and with the sensors, in words."""
    model, faults = vars(config.model), vars(config.faults)
    factors = {key.replace("_", " "): model[key] for key in FACTORS}
    errors = [f"{words} x {factor:g}" for words, factor in factors.items() if factor != 1.0]
    if model["water_level"]:
        errors.append(f"water level {model['water_level']:+g} m")
    errors += [words.format(faults[key]) for key, words in FAULTS.items() if faults[key]]
    return ", ".join(errors)


def describe_noise(config: TowerConfig, summary: pd.DataFrame) -> list[str]:
    """Return in words what 1 % of noise is, and the assumed noise of inclinometers."""
    lines: list[str] = []
    means = (summary["mean"] / summary["noise"]).groupby(summary["measure"]).mean()
    noises = [
        f"{words} has {means[name] / size:.2g} {unit}"
        for name, (words, unit, size) in NOISES.items()
        if name in means
    ]
    if noises:
        lines.append(
            f"At 1 % of noise the quietest {', the quietest '.join(noises)}, fore-aft "
            f"(standard deviation per sample at {config.record.rate:g} Hz)."
        )
    if config.sensors.inclinometers or "inclinometers" in config.sensors.every_node:
        lines.append(
            "The inclinometers here read theta - a/g, and no scheme knows it."
            if config.faults.accelerated_inclinometers
            else "A real inclinometer reads theta - a/g, which no scheme here knows: "
            "faults.accelerated_inclinometers=true says what that costs."
        )
    return lines


def describe_sight(config: TowerConfig) -> list[str]:
    """Say in a few lines what the set-up sees in each direction, and why it misses the rest."""
    setting = set_up(config)
    seen = observe(model_cut(setting))
    missed = find_missed(setting, seen)
    kinds = {channel.kind for channel in setting.channels}
    lines = [
        f"Of a direction's motion and loads, sensors {config.sensors.name} see {seen.rank} of "
        f"{seen.states} states (rank by PBH); what is seen has a condition number of up to "
        f"{seen.conditions.max():.0f}."
    ]
    lines += [
        words for (name, kind), words in UNSEEN.items() if name in missed and kind not in kinds
    ]
    loads = [name for name in INPUTS if name in missed]
    if loads:
        lines.append(
            f"Constant {', '.join(loads)} that balance each other are unseen, because no sensor "
            "tells the bent shape at rest apart. Inclinometers do."
        )
    return lines


def _tell_more(config: TowerConfig, tables: Mapping[str, pd.DataFrame]) -> list[str]:
    return [*describe_noise(config, tables["summary"]), *describe_sight(config)]


#: Measured on one core of a server of 2026, 200 s at 100 Hz.
COSTS = Costs(
    record=42e-6,
    schemes={
        "AKF": 9e-6, "AKF_LAGGED": 14e-6, "AKF_MATERN12": 5e-6, "AKF_MATERN32": 7e-6,
        "AKF_WAVE": 51e-6, "AKF_STEADY": 12e-6, "GDF": 6e-6, "DUAL": 2e-6, "AKF_WHOLE": 7.5e-6,
        "AKF_WHOLE_WAVE": 33e-6, "KF_WHOLE": 3.5e-6, "MDE": 4e-6, "THRUST_LEVER": 3e-6,
        "QUASI_STATIC": 3e-6,
    },
    memory=490e6,
)  # fmt: skip

CONTEST = Contest(
    conditions=CONDITIONS,
    criteria=CRITERIA,
    measures=tuple(CRITERIA),
    describe_truth=describe_truth,
    describe_sensors=describe_sensors,
    # keys of sensors and faults scale noise, but draw no other numbers
    pairing=("seed", "structure", "record", "truth", "recorded", "wind", "waves"),
    ties_from=16,  # a record of the whole map costs more than 20 s
    tell_more=_tell_more,
    costs=COSTS,
)
