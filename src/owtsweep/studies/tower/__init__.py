"""The tower study: loads, motion and fatigue of a substructure from few sensors.

Estimators of input and state on a structure between two cuts, after Simpson et al. (2025).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from owtsweep import estimation, evaluation, motion, sensing, structures, waves
from owtsweep.figures import palette
from owtsweep.studies.tower.looks import LOOKS
from owtsweep.sweep.study import Study, add_versions

if TYPE_CHECKING:
    from owtsweep.evaluation.estimate import EstimatedRecord
    from owtsweep.results.conditions import Condition
    from owtsweep.studies.tower.config import TowerConfig
    from owtsweep.sweep.study import Engine

__all__ = ["TowerStudy"]

#: Packages whose code affects the numbers that the study stores.
ROOMS = (waves, structures, sensing, motion, estimation, evaluation)

palette.reserve(LOOKS)


class TowerStudy(Study):
    """The study of a substructure between two cuts."""

    name = "tower"
    #: The script that judges the statements of the study's paper.
    judged_by = "experiments/tower/fidelity.py"
    schema_version = 1
    numerics_version = add_versions(3, *ROOMS)

    def schemes(self) -> dict[str, str]:
        """Return name -> description of each scheme."""
        from owtsweep.studies.tower.schemes import REGISTERED

        return REGISTERED

    def config_type(self) -> type[TowerConfig]:
        """Return the class of the study's configurations."""
        from owtsweep.studies.tower.config import TowerConfig

        return TowerConfig

    def complete(self, plain: dict[str, Any]) -> dict[str, Any]:
        """Return the keys with the content of a structure in place of its name or file.

        Raises
        ------
        InputError
            If there is no such structure.
        """
        from owtsweep.config.typed import as_mapping

        if not isinstance(plain.get("structure"), str):
            return plain
        return {**plain, "structure": as_mapping(structures.find_structure(plain["structure"]))}

    def check(self, config: TowerConfig) -> None:
        """Check that the values can work together.

        Raises
        ------
        InputError
            If two values cannot work together; the message says what would work.
        """
        from owtsweep.studies.tower.checks import check

        check(config)

    def check_outside(self, config: TowerConfig) -> None:
        """Raise `InputError` if a file of recorded loads or of a record cannot be used."""
        from owtsweep.studies.tower.checks import check_files

        check_files(config)

    def describe_origin(self, config: TowerConfig) -> str:
        """Return in a line the tuning, the truth, the sensors, the records and their seed."""
        from owtsweep.studies.tower.origin import describe_origin

        return describe_origin(config)

    def conditions(self, config: TowerConfig) -> tuple[Condition, ...]:
        """Return the axes of the grid: sensor noise, and the soil of the schemes' model."""
        from owtsweep.studies.tower.conditions import CONDITIONS

        return CONDITIONS

    def engine(self, config: TowerConfig) -> Engine:
        """Return the study's only engine."""
        from owtsweep.studies.tower.engine import TowerEngine

        return TowerEngine()

    def estimate(self, config: TowerConfig, replicate: int) -> EstimatedRecord:
        """Return a record of the grid's only cell, with the estimates of all schemes."""
        from owtsweep.studies.tower.estimating import estimate_record

        return estimate_record(config, replicate)
