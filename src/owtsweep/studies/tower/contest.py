"""What is the tower study's own in the contest of its schemes: axes and criteria."""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.results.conditions import Condition
from owtsweep.studies.base.contest import Contest
from owtsweep.studies.tower.describe import (
    describe_noise,
    describe_sensors,
    describe_sight,
    describe_truth,
)
from owtsweep.studies.tower.measures import CRITERIA, list_measures

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
