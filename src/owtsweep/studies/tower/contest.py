"""What is the tower study's own in the contest of its schemes: axes, criteria and words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.studies.base.contest import Contest
from owtsweep.studies.tower.conditions import CONDITIONS
from owtsweep.studies.tower.measures import CRITERIA, list_measures
from owtsweep.studies.tower.origin import describe_noise, describe_sensors, describe_truth
from owtsweep.studies.tower.sight import describe_sight

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd

    from owtsweep.studies.tower.config import TowerConfig


def _tell_more(config: TowerConfig, tables: Mapping[str, pd.DataFrame]) -> list[str]:
    return [*describe_noise(config, tables["summary"]), *describe_sight(config)]


CONTEST = Contest(
    conditions=CONDITIONS,
    criteria=CRITERIA,
    list_measures=list_measures,
    describe_truth=describe_truth,
    describe_sensors=describe_sensors,
    # keys of sensors and faults scale noise, but draw nothing anew
    pairing=("seed", "structure", "record", "truth", "recorded", "wind", "waves"),
    find_axes=lambda config: tuple(condition.name for condition in CONDITIONS),
    tell_more=_tell_more,
)
