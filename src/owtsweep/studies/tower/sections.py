"""The sections of the tower study's configuration that are its own."""

from __future__ import annotations

from typing import Literal

from owtsweep.config import Axis, Finite, NotNegative, Positive, Section, key

#: Name of a list of sensors in the section `sensors` -> kind of its channels.
KINDS: dict[str, Literal["x", "theta", "a", "strain"]] = {
    "displacement": "x",
    "inclinometers": "theta",
    "accelerometers": "a",
    "strain": "strain",
}


class Grid(Section):
    """The section `grid`: what is swept over."""

    noise: Axis[NotNegative] = key(
        "standard deviation of a sensor's white noise, as a part of its signal's own", unit="%"
    )
    soil_factor: Axis[Positive] = key(
        "stiffness of the soil in the schemes' model over the true one; 1: right"
    )
    replicates: int = key(
        "records per cell, each with its own seed of wind and waves", ge=1, le=10_000,
        advice="use 1 or more",
    )  # fmt: skip


class Truth(Section):
    """The section `truth`: the structure as it is."""

    gravity: bool = key("whether the weight softens the structure (p-delta)")
    subdivision: int = key(
        "elements of the truth in each element of the schemes' mesh", ge=1, le=10
    )


class Sensors(Section):
    """The section `sensors`: where sensors are; each measures fore-aft and side-side.

    Heights are in m above the ground, at nodes of the mesh.
    """

    name: str = key("name of the set-up, for titles")
    every_node: list[Literal["displacement", "inclinometers", "accelerometers", "strain"]] = key(
        "which sensors are at every node, besides those listed below"
    )
    displacement: list[Finite] = key("displacement sensors", unit="m")
    inclinometers: list[Finite] = key("inclinometers", unit="m")
    accelerometers: list[Finite] = key("accelerometers", unit="m")
    strain: list[Finite] = key("strain gauges on the outer fibre", unit="m")
    gnss: list[Finite] = key("GNSS receivers: displacement with a noise of its own", unit="m")
    gnss_sigma: Positive = key(
        "standard deviation of a GNSS sample; of fixes at another rate, times the square root of "
        "rate.record / rate.fixes",
        unit="m",
    )


class Model(Section):
    """The section `model`: the schemes' model of the structure, and what is wrong in it."""

    modes: int = key("free-interface normal modes of the substructure", ge=1, le=100)
    whole_modes: int = key("modes of the whole structure", ge=1, le=100)
    gravity: bool = key("whether the weight softens the model")
    stiffness: Positive = key("factor on E I of the tubes; 1: right")
    mass: Positive = key("factor on the mass of the tubes; 1: right")
    water_level: Finite = key("height of the model's sea level above the true one", unit="m")
    damping: Positive = key("factor on all damping; 1: right")
    rotor_mass: Positive = key("factor on mass and inertia of rotor and nacelle; 1: right")
