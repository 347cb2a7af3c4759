"""The tower study: loads, motion and fatigue of a substructure from few sensors.

Estimators of input and state on a structure between two cuts, after Simpson et al. (2025).
"""

from __future__ import annotations

from collections.abc import Collection

from owtsweep import estimation, evaluation, motion, sensing, structures, waves
from owtsweep.config import Plain
from owtsweep.config.typed import as_mapping
from owtsweep.studies.base.study import DeclaredStudy
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.sweep.study import Lever, Placed, PlaceQuestion, add_versions, halve, halve_logarithm

__all__ = ["TowerStudy"]


class TowerStudy(DeclaredStudy):
    """The study of a substructure between two cuts."""

    name = "tower"
    levers = (
        Lever("half the noise of all sensors", "grid.noise", halve),
        Lever("half the error of the soil's stiffness", "grid.soil_factor", halve_logarithm),
        Lever("sensors at every node", "sensors", lambda sensors: "dense_theta_a"),
    )
    stretched = ("displacement_fa", -2, "displacement of the top, fore-aft (m)")
    numerics_version = add_versions(4, waves, structures, sensing, motion, estimation, evaluation)
    commands = DeclaredStudy.commands | {"place", "tune"}

    def complete(self, plain: Plain) -> Plain:
        """Return the keys with the content of a structure in place of its name or file.

        Raise `InputError` if there is no such structure.
        """
        if not isinstance(plain.get("structure"), str):
            return plain
        return {**plain, "structure": as_mapping(structures.find_structure(plain["structure"]))}

    def list_place_defaults(self, given: Collection[str]) -> list[str]:
        """Return the overrides of `place`: one noise, and accelerometers if no sensor is given."""
        from owtsweep.studies.tower.placing import list_defaults

        return list_defaults(given)

    def place(self, config: TowerConfig, question: PlaceQuestion) -> Placed:
        """Choose inclinometers one by one by the error that the AKF's covariance predicts."""
        from owtsweep.studies.tower.placing import place

        return place(config, question)
