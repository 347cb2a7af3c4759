"""What is the tower study's own in the contest of its schemes: axes, criteria and words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.gravity import GRAVITY
from owtsweep.results.conditions import Condition
from owtsweep.studies.base.contest import Contest
from owtsweep.studies.tower.measures import CRITERIA, QUIETEST, list_measures
from owtsweep.studies.tower.sight import describe_sight

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd

    from owtsweep.studies.tower.config import TowerConfig

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


def describe_truth(config: TowerConfig) -> str:
    """Return structure, loads and length of the records in words."""
    sea = config.waves
    waves = f"waves Hs {sea.hs:g} m, Tp {sea.tp:g} s, yaw {sea.yaw:g}°" if sea.hs else "no waves"
    wind = f"loads of {config.wind.file}" if config.wind.file else f"wind {config.wind.speed:g} m/s"
    gravity = "" if config.truth.gravity else ", without gravity"
    return f"{config.structure.name}, {wind}, {waves}{gravity}, {config.record.duration:g} s"


def describe_sensors(config: TowerConfig) -> str:
    """Return the set-up's name, and in words what is wrong with it and with the schemes' model."""
    wrong = describe_errors(config)
    return f"{config.sensors.name}{f'; wrong: {wrong}' if wrong else ''}"


def describe_errors(config: TowerConfig) -> str:
    """Return in words what is wrong in the schemes' model and with sensors; "" if nothing is."""
    model = config.model
    factors = {
        "stiffness": model.stiffness,
        "mass": model.mass,
        "damping": model.damping,
        "rotor mass": model.rotor_mass,
    }
    errors = [f"{name} x {factor:g}" for name, factor in factors.items() if factor != 1.0]
    if model.water_level:
        errors.append(f"water level {model.water_level:+g} m")
    faults = config.faults
    errors += [
        f"{name} {size:g} of sigma"
        for name, size in (("bias", faults.bias), ("drift", faults.drift))
        if size
    ]
    if faults.loss:
        errors.append(f"loss {faults.loss:g}")
    if faults.tilted_accelerometers:
        errors.append("accelerometers feel tilt")
    if faults.accelerated_inclinometers:
        errors.append("inclinometers feel acceleration")
    return ", ".join(errors)


def describe_noise(config: TowerConfig, summary: pd.DataFrame) -> list[str]:
    """Return in words what 1 % of noise is, and the assumed noise of inclinometers."""
    lines: list[str] = []
    sentences = []
    for name, words, unit, size in (
        (QUIETEST["theta"], "inclinometer", "microrad", 1e-6),
        (QUIETEST["a"], "accelerometer", "micro-g", 1e-6 * GRAVITY),
    ):
        part = summary[summary["measure"] == name]
        if len(part):
            sentences.append(
                f"{words} has {(part['mean'] / part['noise']).mean() / size:.2g} {unit}"
            )
    if sentences:
        lines.append(
            f"At 1 % of noise the quietest {', the quietest '.join(sentences)}, fore-aft "
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


def _tell_more(config: TowerConfig, tables: Mapping[str, pd.DataFrame]) -> list[str]:
    return [*describe_noise(config, tables["summary"]), *describe_sight(config)]


CONTEST = Contest(
    conditions=CONDITIONS,
    criteria=CRITERIA,
    list_measures=list_measures,
    describe_truth=describe_truth,
    describe_sensors=describe_sensors,
    # keys of sensors and faults scale noise, but draw no other numbers
    pairing=("seed", "structure", "record", "truth", "recorded", "wind", "waves"),
    find_axes=lambda config: tuple(condition.name for condition in CONDITIONS),
    ties_from=16,  # a record of the whole map costs more than 20 s
    tell_more=_tell_more,
)
