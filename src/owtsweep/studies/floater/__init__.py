"""The floater study: position and velocity of a floating structure in a basin, for its actuators.

Kinematic estimators in six degrees of freedom, after Mehammer et al. (2018).
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep import estimation, evaluation, motion, sensing, waves
from owtsweep.figures import palette
from owtsweep.studies.floater.looks import LOOKS
from owtsweep.sweep.study import Study, add_versions

if TYPE_CHECKING:
    from owtsweep.comparing.comparison import Comparison, Findings
    from owtsweep.evaluation.estimate import EstimatedRecord
    from owtsweep.results.conditions import Condition
    from owtsweep.studies.floater.config import FloaterConfig
    from owtsweep.sweep.study import Engine

__all__ = ["FloaterStudy"]

#: Packages whose code affects the numbers that the study stores.
ROOMS = (waves, sensing, motion, estimation, evaluation)

palette.reserve(LOOKS)


class FloaterStudy(Study):
    """The study of a floating structure in a basin."""

    name = "floater"
    #: The script that judges the statements of the study's paper.
    judged_by = "experiments/floater/fidelity.py"
    schema_version = 1
    numerics_version = add_versions(1, *ROOMS)

    def schemes(self) -> dict[str, str]:
        """Return name -> description of each scheme."""
        from owtsweep.studies.floater.schemes import REGISTERED

        return REGISTERED

    def config_type(self) -> type[FloaterConfig]:
        """Return the class of the study's configurations."""
        from owtsweep.studies.floater.config import FloaterConfig

        return FloaterConfig

    def check(self, config: FloaterConfig) -> None:
        """Check that the values can work together.

        Raises
        ------
        InputError
            If two values cannot work together; the message says what would work.
        """
        from owtsweep.studies.floater.checks import check

        check(config)

    def check_outside(self, config: FloaterConfig) -> None:
        """Raise `InputError` if the file of a recorded motion cannot be used."""
        from owtsweep.studies.floater.checks_record import check_file

        check_file(config)

    def describe_origin(self, config: FloaterConfig) -> str:
        """Return in a line the tuning, the truth, the sensors, the records and their seed."""
        from owtsweep.studies.contest.origin import describe_origin
        from owtsweep.studies.floater.contest import CONTEST

        return describe_origin(CONTEST, config)

    def conditions(self, config: FloaterConfig) -> tuple[Condition, ...]:
        """Return the two axes of the map, those of the key `axes`."""
        from owtsweep.studies.floater.contest import CONTEST

        return CONTEST.find_conditions(config.axes)

    def engine(self, config: FloaterConfig) -> Engine:
        """Return the study's only engine."""
        from owtsweep.studies.floater.engine import FloaterEngine

        return FloaterEngine()

    def estimate(self, config: FloaterConfig, replicate: int) -> EstimatedRecord:
        """Return a record of the grid's only cell, with the estimates of all schemes."""
        from owtsweep.studies.floater.estimating import estimate_record

        return estimate_record(config, replicate)

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
        from owtsweep.studies.floater.comparing import describe_run

        return compare(comparison, folder, describe_run, metadata=metadata)
