"""The blade study: where a hoisted blade's root is, from GNSS and an inertial unit on it.

After Maes, De Roeck and Lombaert (2018).
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep import estimation, motion
from owtsweep.figures import palette
from owtsweep.studies.blade.looks import LOOKS
from owtsweep.sweep.study import Study, add_versions

if TYPE_CHECKING:
    from owtsweep.comparing.comparison import Comparison, Findings
    from owtsweep.evaluation.estimate import EstimatedRecord
    from owtsweep.results.conditions import Condition
    from owtsweep.studies.blade.config import BladeConfig
    from owtsweep.sweep.study import Engine

__all__ = ["BladeStudy"]

#: Packages whose code affects the numbers that the study stores.
ROOMS = (motion, estimation)

palette.reserve(LOOKS)


class BladeStudy(Study):
    """The study of a hoisted blade."""

    name = "blade"
    #: The script that judges the statements of the study's paper.
    judged_by = "experiments/blade/fidelity.py"
    schema_version = 1
    numerics_version = add_versions(1, *ROOMS)

    def schemes(self) -> dict[str, str]:
        """Return name -> description of each scheme."""
        from owtsweep.studies.blade.schemes import REGISTERED

        return REGISTERED

    def config_type(self) -> type[BladeConfig]:
        """Return the class of the study's configurations."""
        from owtsweep.studies.blade.config import BladeConfig

        return BladeConfig

    def check(self, config: BladeConfig) -> None:
        """Check that the values can work together.

        Raises
        ------
        InputError
            If two values cannot work together; the message says what would work.
        """
        from owtsweep.studies.blade.checks import check

        check(config)

    def check_outside(self, config: BladeConfig) -> None:
        """Raise `InputError` if a file of a recorded lift cannot be used."""
        from owtsweep.studies.blade.recorded_case import load_lift

        if config.recorded.imu is not None:
            load_lift(config)

    def describe_origin(self, config: BladeConfig) -> str:
        """Return in a line the tuning, the truth, the sensors, the records and their seed."""
        from owtsweep.studies.blade.contest import CONTEST
        from owtsweep.studies.contest.origin import describe_origin

        return describe_origin(CONTEST, config)

    def conditions(self, config: BladeConfig) -> tuple[Condition, ...]:
        """Return the two axes of the map, those of the key `axes`."""
        from owtsweep.studies.blade.contest import CONTEST

        return CONTEST.find_conditions(config.axes)

    def engine(self, config: BladeConfig) -> Engine:
        """Return the study's only engine."""
        from owtsweep.studies.blade.engine import BladeEngine

        return BladeEngine()

    def estimate(self, config: BladeConfig, replicate: int) -> EstimatedRecord:
        """Return a record of the grid's only cell, with the estimates of all schemes."""
        from owtsweep.studies.blade.estimating import estimate_record

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
        from owtsweep.studies.blade.comparing import describe_run

        return compare(comparison, folder, describe_run, metadata=metadata)
