"""The study that searches with Optuna for readings of the paper, and for tunings of each scheme.

A reading of the paper is a choice of the values that the paper leaves open.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.errors import require
from owtsweep.studies.hub.public import ROOMS, HubKeys
from owtsweep.sweep.study import add_versions

if TYPE_CHECKING:
    from owtsweep.results.conditions import Condition
    from owtsweep.studies.hub.public import HubConfig
    from owtsweep.studies.readings.config import ReadingsConfig
    from owtsweep.sweep.study import Engine

__all__ = ["ReadingsStudy"]


class ReadingsStudy(HubKeys):
    """The study that searches with Optuna for readings of the paper.

    A block of its plan is one search with one seed.
    """

    name = "readings"
    schema_version = 1
    numerics_version = add_versions(1, *ROOMS)

    def config_type(self) -> type[ReadingsConfig]:
        """Return the configuration's type: the hub study's keys and a section `calibration`."""
        from owtsweep.studies.readings.config import ReadingsConfig

        return ReadingsConfig

    def check(self, config: HubConfig) -> None:
        """Raise `InputError` unless values can work together and the motion has a spectrum."""
        from owtsweep.studies.hub.public import find_world

        require(
            find_world(config).has_spectrum,
            "motion: the search compares with numbers of a spectrum; leave out "
            f"motion={config.motion.kind}",
        )
        super().check(config)

    def conditions(self, config: ReadingsConfig) -> tuple[Condition, ...]:
        """Return an empty tuple: a search has no grid of conditions."""
        return ()

    def engine(self, config: ReadingsConfig) -> Engine:
        """Return the study's only engine, which does not depend on the configuration."""
        from owtsweep.studies.readings.engine import SearchEngine

        return SearchEngine()
