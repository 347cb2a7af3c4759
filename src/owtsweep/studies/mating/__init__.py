"""The mating study: the motion of a blade's root relative to the hub, from both their estimates.

Its records are those of the studies `blade` and `hub`, taken through `owtsweep.estimate`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.studies.base.study import ContestStudy
from owtsweep.studies.registry import get_study, list_schemes

if TYPE_CHECKING:
    from owtsweep.studies.mating.config import MatingConfig
    from owtsweep.sweep.study import Engine

__all__ = ["MatingStudy"]


class MatingStudy(ContestStudy):
    """The study of a blade's mating with the hub."""

    name = "mating"
    numerics_version = 1 + get_study("blade").numerics_version + get_study("hub").numerics_version

    def schemes(self) -> dict[str, str]:
        return dict(list_schemes("blade"))

    def engine(self, config: MatingConfig) -> Engine:
        """Return the study's only engine."""
        from owtsweep.studies.mating.engine import MatingEngine

        return MatingEngine()
