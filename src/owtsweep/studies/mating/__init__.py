"""The mating study: the motion of a blade's root relative to the hub, from both their estimates.

Its records are those of the studies `blade` and `hub`, taken through `owtsweep.estimate`.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.studies.registry import get_study
from owtsweep.sweep.study import Study

if TYPE_CHECKING:
    from owtsweep.comparing.comparison import Comparison, Findings
    from owtsweep.results.conditions import Condition
    from owtsweep.studies.mating.config import MatingConfig
    from owtsweep.sweep.study import Engine

__all__ = ["MatingStudy"]


class MatingStudy(Study):
    """The study of a blade's mating with the hub."""

    name = "mating"
    schema_version = 1
    numerics_version = 1 + get_study("blade").numerics_version + get_study("hub").numerics_version

    def schemes(self) -> dict[str, str]:
        """Return name -> description of each scheme: those of the blade study."""
        return get_study("blade").schemes()  # type: ignore[attr-defined,no-any-return]

    def config_type(self) -> type[MatingConfig]:
        """Return the class of the study's configurations."""
        from owtsweep.studies.mating.config import MatingConfig

        return MatingConfig

    def check(self, config: MatingConfig) -> None:
        """Check that the values can work together.

        Raises
        ------
        InputError
            If two values cannot work together; the message says what would work.
        """
        from owtsweep.studies.mating.checks import check

        check(config)

    def check_outside(self, config: MatingConfig) -> None:
        """Raise `InputError` if one of the other studies refuses its keys."""
        from owtsweep.studies.mating.checks import check_others

        check_others(config)

    def describe_origin(self, config: MatingConfig) -> str:
        """Return in a line the tuning, the truth, the sensors, the records and their seed."""
        from owtsweep.studies.contest.origin import describe_origin
        from owtsweep.studies.mating.contest import CONTEST

        return describe_origin(CONTEST, config)

    def conditions(self, config: MatingConfig) -> tuple[Condition, ...]:
        """Return the two axes of the map, those of the key `axes`."""
        from owtsweep.studies.mating.contest import CONTEST

        return CONTEST.find_conditions(config.axes)

    def engine(self, config: MatingConfig) -> Engine:
        """Return the study's only engine."""
        from owtsweep.studies.mating.engine import MatingEngine

        return MatingEngine()

    def compare(
        self, comparison: Comparison, folder: Path, *, metadata: Mapping[str, str]
    ) -> Findings:
        """Compare runs over the same axes: how best scheme and errors change between them.

        Parameters
        ----------
        comparison
            The runs, and the pairs of runs to compare.
        folder
            The folder for the figures. The tables are returned, not written.
        metadata
            Texts by name to store inside the figures' files.

        Raises
        ------
        InputError
            If the runs cannot be compared.
        """
        from owtsweep.comparing.compare import compare
        from owtsweep.studies.mating.comparing import describe_run

        return compare(comparison, folder, describe_run, metadata=metadata)
