"""The mating study: the motion of a blade's root relative to the hub, from both their estimates.

Its records are those of the studies `blade` and `hub`, taken through `owtsweep.estimate`.
"""

from __future__ import annotations

from owtsweep.studies.base.schemes import SchemeTable
from owtsweep.studies.base.study import ContestStudy
from owtsweep.studies.mating.config import MatingConfig
from owtsweep.studies.registry import get_study
from owtsweep.sweep.study import Engine, Lever, halve

__all__ = ["MatingStudy"]


def _find_blade() -> ContestStudy:
    blade = get_study("blade")
    assert isinstance(blade, ContestStudy)
    return blade


class MatingStudy(ContestStudy):
    """The study of a blade's mating with the hub."""

    name = "mating"
    levers = (
        Lever("half the noise of a fix on the blade", "grid.sigma", halve),
        Lever("half the noise of a fix on the hub", "grid.hub_sigma", halve),
        Lever("half the length of an outage on the blade", "grid.outage", halve),
    )
    most_samples = _find_blade().most_samples
    numerics_version = 1 + get_study("blade").numerics_version + get_study("hub").numerics_version

    def scheme_table(self) -> SchemeTable:
        """Return the schemes of the blade study."""
        return _find_blade().scheme_table()

    def engine(self, config: MatingConfig) -> Engine:
        """Return the study's only engine."""
        from owtsweep.studies.mating.engine import MatingEngine

        return MatingEngine(_find_blade())
