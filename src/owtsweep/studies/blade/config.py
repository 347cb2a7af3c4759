"""The configuration of the blade study: its keys, types, bounds and meanings."""

from __future__ import annotations

from typing import ClassVar, Literal

from owtsweep.config import Config, key
from owtsweep.config.common import Record
from owtsweep.config.tuned import ABSENT, TunedConfig
from owtsweep.studies.base.contest import ContestConfig
from owtsweep.studies.base.keys import (
    Tune,
    key_of_axes,
    key_of_schemes,
    key_of_tune,
    key_of_tuning,
    key_of_tunings,
)
from owtsweep.studies.base.schemes import SchemeEntries
from owtsweep.studies.blade.recorded import Recorded
from owtsweep.studies.blade.sections import Boom, Grid, Motion, Sensors, Unit
from owtsweep.studies.blade.tuning import Tuned, Tuning


class BladeConfig(TunedConfig, ContestConfig):
    """The configuration of the blade study, with all its keys."""

    inert: ClassVar[frozenset[str]] = Config.inert | {"axes", "criterion", "tuning", "grade"}
    tuned: ClassVar[tuple[str, ...]] = ("filters",)

    grid: Grid = key("what is swept over")
    axes: list[str] = key_of_axes(Grid)
    record: Record = key("a record of motion and measurements")
    motion: Motion = key("how the blade moves on its hook")
    boom: Boom = key("the crane's boom and its accelerometers", default=Boom())
    unit: Unit = key("the inertial unit, set by unit=NAME; it does not feel Earth's rotation")
    grade: str = key("what the inertial unit is called, set by unit=NAME")
    recorded: Recorded = key(
        "a recorded lift in place of a simulated one (docs/blade.md)", default=Recorded()
    )  # fmt: skip
    sensors: Sensors = key("GNSS and total stations")
    tuning: str | list[str] = key_of_tuning()
    tunings: dict[str, Tuned] = key_of_tunings()
    filters: Tuning = key("what schemes assume, and their own numbers", default=ABSENT)
    tune: Tune = key_of_tune()
    schemes: SchemeEntries = key_of_schemes()
    criterion: Literal["root", "attitude", "worst"] = key("what the map on the terminal judges")


#: What `studies.base` looks for.
CONFIG = BladeConfig
