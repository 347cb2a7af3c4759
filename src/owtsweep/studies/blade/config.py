"""The configuration of the blade study: its keys, types, bounds and meanings."""

from __future__ import annotations

from typing import ClassVar, Literal

from owtsweep.config import key
from owtsweep.studies.base.keys import FilteredConfig, Tuned, key_of_axes
from owtsweep.studies.blade.recorded import Recorded
from owtsweep.studies.blade.sections import Boom, Grid, Motion, Sensors, Unit
from owtsweep.studies.blade.tuning import Tuning


class BladeConfig(FilteredConfig[Grid, Tuning, Tuned[Tuning]]):
    """The configuration of the blade study, with all its keys."""

    inert: ClassVar[frozenset[str]] = FilteredConfig.inert | {"grade"}

    axes: list[str] = key_of_axes(Grid)
    motion: Motion = key("how the blade moves on its hook")
    boom: Boom = key("the crane's boom and its accelerometers", default=Boom())
    unit: Unit = key("the inertial unit, set by unit=NAME; it does not feel Earth's rotation")
    grade: str = key("what the inertial unit is called, set by unit=NAME")
    recorded: Recorded = key(
        "a recorded lift in place of a simulated one (docs/blade.md)", default=Recorded()
    )  # fmt: skip
    sensors: Sensors = key("GNSS and total stations")
    criterion: Literal["root", "attitude", "worst"] = key("what the map on the terminal judges")


#: What `studies.base` looks for.
CONFIG = BladeConfig
