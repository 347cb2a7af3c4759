"""The configuration of the tower study: its keys, types, bounds and meanings."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from owtsweep.config import Config, Finite, key
from owtsweep.config.typed import as_plain
from owtsweep.structures import Structure, find_structure
from owtsweep.structures.sn_curves import Fatigue
from owtsweep.studies.tower.loads.config import SeaState, Wind
from owtsweep.studies.tower.measuring import Faults
from owtsweep.studies.tower.sections import Grid, Model, Record, Sensors, Truth
from owtsweep.studies.tower.tuning import Tuning


class TowerConfig(Config):
    """The configuration of the tower study, with all its keys."""

    inert: ClassVar[frozenset[str]] = Config.inert | {
        "criterion", "sensors.name", "structure.name", "structure.source", "tuning",
    }  # fmt: skip

    structure: Structure = key("a name in conf/structure, or a YAML file; config.yaml holds all of it")
    cuts: list[Finite] | None = key(
        "heights of the lower and the upper cut above the ground; null: the ground and the top of "
        "the structure",
        unit="m",
        form="two heights in m above the ground, e.g. cuts=[0,175]",
        min_length=2,
        max_length=2,
    )
    grid: Grid = key("the axes of the sweep")
    record: Record = key("a record of loads, motion and measurements")
    truth: Truth = key("the structure as it is")
    wind: Wind = key("loads of the rotor on the top")
    waves: SeaState = key("the sea, set by sea=NAME")
    sensors: Sensors = key("where sensors are")
    faults: Faults = key("what is wrong with sensors besides white noise")
    tuning: str = key("name of the file that sets the section `filters`")
    filters: Tuning = key("numbers of all schemes")
    model: Model = key("the schemes' model of the structure, and what is wrong in it")
    fatigue: Fatigue = key("welds and material")
    schemes: list[str] = key("names; `owtsweep list` says what each is", min_length=1)
    criterion: Literal["damage", "base_moment", "displacement"] = key(
        "what the map on the terminal judges"
    )

    @property
    def heights(self) -> tuple[float, float]:
        """The heights of both cuts above mean sea level, m."""
        if self.cuts is None:
            return self.structure.mudline, self.structure.hub
        low, high = self.cuts
        return self.structure.mudline + low, self.structure.mudline + high

    @classmethod
    def complete(cls, plain: dict[str, Any]) -> dict[str, Any]:
        """Return the keys with the content of a structure in place of its name or file.

        Raises
        ------
        InputError
            If there is no such structure.
        """
        if not isinstance(plain.get("structure"), str):
            return plain
        return {**plain, "structure": as_plain(find_structure(plain["structure"]))}

    def describe_origin(self) -> str:
        """Return in a line the tuning, the truth, the sensors, the records and their seed."""
        from owtsweep.studies.tower.origin import describe_origin

        return describe_origin(self)

    def check(self) -> None:
        """Check that the values can work together.

        Raises
        ------
        InputError
            If two values cannot work together; the message says what would work.
        """
        super().check()
        from owtsweep.studies.tower.checks import check

        check(self)
