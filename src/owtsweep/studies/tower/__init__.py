"""The tower study: loads, motion and fatigue of a substructure from few sensors.

Estimators of input and state on a structure between two cuts, after Simpson et al. (2025).
"""

from __future__ import annotations

from typing import Any

from owtsweep import estimation, evaluation, motion, sensing, structures, waves
from owtsweep.studies.base.study import DeclaredStudy
from owtsweep.sweep.study import add_versions

__all__ = ["TowerStudy"]


class TowerStudy(DeclaredStudy):
    """The study of a substructure between two cuts."""

    name = "tower"
    #: The script that judges the statements of the study's paper.
    judged_by = "experiments/tower/fidelity.py"
    numerics_version = add_versions(3, waves, structures, sensing, motion, estimation, evaluation)

    def complete(self, plain: dict[str, Any]) -> dict[str, Any]:
        """Return the keys with the content of a structure in place of its name or file.

        Raises
        ------
        InputError
            If there is no such structure.
        """
        from owtsweep.config.typed import as_plain

        if not isinstance(plain.get("structure"), str):
            return plain
        return {**plain, "structure": as_plain(structures.find_structure(plain["structure"]))}
