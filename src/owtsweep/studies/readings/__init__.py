"""The calibration as a study: searches readings of the paper, and fair tunings, with Optuna."""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.studies.hub.public import ROOMS
from owtsweep.sweep.study import add_versions

if TYPE_CHECKING:
    from owtsweep.results.conditions import Condition
    from owtsweep.studies.readings.config import ReadingsConfig
    from owtsweep.sweep.study import Engine

__all__ = ["ReadingsStudy"]


class ReadingsStudy:
    """The study that searches readings of the paper; a block is one search with one seed."""

    name = "readings"
    schema_version = 1
    numerics_version = add_versions(1, *ROOMS)

    def config_type(self) -> type[ReadingsConfig]:
        """Return the configuration's type: the hub study's, with a section `calibration`."""
        from owtsweep.studies.readings.config import ReadingsConfig

        return ReadingsConfig

    def conditions(self, config: ReadingsConfig) -> tuple[Condition, ...]:
        """Return no conditions, because a search has no grid."""
        return ()

    def engine(self, config: ReadingsConfig) -> Engine:
        """Return the study's only engine."""
        from owtsweep.studies.readings.engine import SearchEngine

        return SearchEngine()
