"""The configuration of the blade study: its keys, types, bounds and meanings."""

from __future__ import annotations

from typing import ClassVar, Literal

from owtsweep.config import Config, key
from owtsweep.config.common import Record
from owtsweep.config.tuned import ABSENT, TunedConfig
from owtsweep.studies.base.contest import ContestConfig
from owtsweep.studies.base.schemes import SchemeEntries
from owtsweep.studies.blade.recorded import Recorded
from owtsweep.studies.blade.sections import Boom, Grid, Motion, Sensors, Unit
from owtsweep.studies.blade.tuning import Tuned, Tuning


class BladeConfig(TunedConfig, ContestConfig):
    """The configuration of the blade study, with all its keys.

    With several tunings, `tuning` is the list of their names, `tunings` holds their sections, and
    the section `filters` is absent. `by_tuning` gives the configuration of each.
    """

    inert: ClassVar[frozenset[str]] = Config.inert | {"axes", "criterion", "tuning", "grade"}
    tuned: ClassVar[tuple[str, ...]] = ("filters",)

    grid: Grid = key("what is swept over")
    axes: list[str] = key(
        "the two axes of the map, the horizontal one first, of sigma, outage, offset, period, "
        "amplitude, lever, heading; plane=NAME sets them and their values",
        min_length=2,
        max_length=2,
        form="two axes, e.g. [sigma,outage]",
    )
    record: Record = key("a record of motion and measurements")
    motion: Motion = key("how the blade moves on its hook")
    boom: Boom = key("the crane's boom and its accelerometers", default=Boom())
    unit: Unit = key("the inertial unit, set by unit=NAME; it does not feel Earth's rotation")
    grade: str = key("what the inertial unit is called, set by unit=NAME")
    recorded: Recorded = key(
        "a recorded lift in place of a simulated one (docs/blade.md)", default=Recorded()
    )  # fmt: skip
    sensors: Sensors = key("GNSS and total stations")
    tuning: str | list[str] = key(
        "name of the file that sets the section `filters`, or a list of names, whose tunings run "
        "on the same records"
    )
    tunings: dict[str, Tuned] = key(
        "name: the section filters of this tuning; only with several tunings", default={}
    )
    filters: Tuning = key("what schemes believe, and their own numbers", default=ABSENT)
    schemes: SchemeEntries = key(
        "names (`owtsweep list` says what each is), or {_target_: package.Class, ...} for a scheme "
        "of your own",
        min_length=1,
    )
    criterion: Literal["root", "attitude", "worst"] = key("what the map on the terminal judges")


#: What `studies.base` looks for.
CONFIG = BladeConfig
