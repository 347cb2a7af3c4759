"""The configuration of the mating study: its keys, types, bounds and meanings."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import BeforeValidator

from owtsweep.config import Axis, NotNegative, Positive, Section, key
from owtsweep.config.grid import Records
from owtsweep.studies.base.keys import ContestConfig, key_of_axes


def _refuse_classes(value: object) -> object:
    """Return `value`; raise `ValueError` if it is a list that holds more than names."""
    for item in value if isinstance(value, list) else []:
        if isinstance(item, Mapping):
            raise ValueError(
                f"{dict(item)} is no name; this study takes schemes of the blade study, by the "
                "names that `owtsweep list` shows; a class of your own (_target_) runs in "
                "study=blade, and in the other studies"
            )
    return value


class Grid(Records):
    """The section `grid`: what is swept over; only the two of `axes` may have many values."""

    sigma: Axis[Positive] = key("standard deviation of a fix of the blade's GNSS", unit="m")
    outage: Axis[NotNegative] = key("length of an outage of the blade's GNSS", unit="s")
    hub_sigma: Axis[Positive] = key("standard deviation of a fix of the hub's GNSS", unit="m")
    hold: Axis[Positive] = key("how long root and hub must stay together", unit="s")


class Limits(Section):
    """The section `limits`: what counts as together."""

    distance: Positive = key("largest distance of the root from its place at the hub", unit="m")
    speed: Positive = key("largest relative speed", unit="m/s")


class MatingConfig(ContestConfig):
    """The configuration of the mating study, with all its keys."""

    grid: Grid = key("what is swept over")
    axes: list[str] = key_of_axes(Grid)
    limits: Limits = key("what counts as together")
    blade: list[str] = key("overrides of study=blade: its motion, inertial unit and sensors")
    hub: list[str] = key("overrides of study=hub: its motion and sensors")
    tuning: str = key("name of the tuning of both studies")
    hub_scheme: str = key("the scheme of the hub study that estimates the hub's motion")
    schemes: Annotated[list[str], BeforeValidator(_refuse_classes)] = key(
        "names of schemes of the blade study, which estimate the root's motion", min_length=1
    )
    criterion: Literal["relative", "speed", "wrong"] = key("what the map on the terminal judges")


#: What `studies.base` looks for.
CONFIG = MatingConfig
