"""The configuration of the tower study: its keys, types, bounds and meanings."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import Finite, key
from owtsweep.structures import Structure
from owtsweep.structures.bernoulli import list_nodes
from owtsweep.structures.sn_curves import Fatigue
from owtsweep.studies.base.keys import FilteredConfig, Tuned
from owtsweep.studies.tower import sections
from owtsweep.studies.tower.tuning import Tuning


class TowerConfig(FilteredConfig[sections.Grid, Tuning, Tuned[Tuning]]):
    """The configuration of the tower study, with all its keys."""

    inert: ClassVar[frozenset[str]] = FilteredConfig.inert | {
        "sensors.name", "structure.name", "structure.source",
    }  # fmt: skip

    structure: Structure = key(
        "a name in conf/structure, or a YAML file; config.yaml holds all of it"
    )
    cuts: list[Finite] | None = key(
        "heights of the lower and the upper cut above the ground; null: the ground and the top of "
        "the structure",
        unit="m",
        form="two heights in m above the ground, e.g. cuts=[0,175]",
        min_length=2,
        max_length=2,
    )
    truth: sections.Truth = key("the structure as it is")
    recorded: sections.Recorded = key("a record of a structure in place of a simulated one")
    wind: sections.Wind = key("loads of the rotor on the top")
    waves: sections.SeaState = key("the sea, set by sea=NAME")
    sensors: sections.Sensors = key("where sensors are")
    faults: sections.Faults = key("what is wrong with sensors besides white noise")
    model: sections.Model = key("the schemes' model of the structure, and what is wrong in it")
    fatigue: Fatigue = key("welds and material")
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

    @property
    def nodes(self) -> Array:
        """The heights of the nodes of the cut structure above the ground, m, shape (nodes,).

        Raise `InputError` if a cut is inside an element, or fewer than two elements lie between the
        cuts.
        """
        return np.asarray(list_nodes(self.structure, *self.heights) - self.structure.mudline)


#: What `studies.base` looks for.
CONFIG = TowerConfig
