"""The floater study: position and velocity of a floating structure in a basin, for its actuators.

Kinematic estimators in six degrees of freedom, after Mehammer et al. (2018).
"""

from __future__ import annotations

from owtsweep import estimation, evaluation, motion, sensing, waves
from owtsweep.studies.base.study import DeclaredStudy
from owtsweep.sweep.study import add_versions

__all__ = ["FloaterStudy"]


class FloaterStudy(DeclaredStudy):
    """The study of a floating structure in a basin."""

    name = "floater"
    stretched = ("position", 2, "heave (m)")
    numerics_version = add_versions(2, waves, sensing, motion, estimation, evaluation)
