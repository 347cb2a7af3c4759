"""The configuration of the floater study: its keys, types, bounds and meanings."""

from __future__ import annotations

from typing import ClassVar, Literal

from owtsweep.config import Config, key
from owtsweep.config.common import Record
from owtsweep.config.tuned import ABSENT, TunedConfig
from owtsweep.studies.base.schemes import SchemeEntries
from owtsweep.studies.floater.sections import Grid, Motion, Sensors
from owtsweep.studies.floater.tuning import Tuned, Tuning


class FloaterConfig(TunedConfig):
    """The configuration of the floater study, with all its keys.

    With several tunings, `tuning` is the list of their names, `tunings` holds their sections, and
    the section `filters` is absent. `by_tuning` gives the configuration of each.
    """

    inert: ClassVar[frozenset[str]] = Config.inert | {"axes", "criterion", "tuning"}
    tuned: ClassVar[tuple[str, ...]] = ("filters",)

    grid: Grid = key("what is swept over")
    axes: list[str] = key(
        "the two axes of the map, the horizontal one first, of delay, bias, snr, loss, believed, "
        "roll; plane=NAME sets them and their values",
        min_length=2,
        max_length=2,
        form="two axes, e.g. [delay,bias]",
    )
    record: Record = key("a record of motion and measurements")
    motion: Motion = key("what moves, set by motion=NAME")
    sensors: Sensors = key("the optical system and the inertial unit")
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
    criterion: Literal["position", "velocity", "worst"] = key("what the map on the terminal judges")


#: What `studies.base` looks for.
CONFIG = FloaterConfig
