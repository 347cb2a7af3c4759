"""The blade study: where a hoisted blade's root is, from GNSS and an inertial unit on it.

After Maes, De Roeck and Lombaert (2018).
"""

from __future__ import annotations

from owtsweep import estimation, motion
from owtsweep.studies.base.study import DeclaredStudy
from owtsweep.sweep.study import add_versions

__all__ = ["BladeStudy"]


class BladeStudy(DeclaredStudy):
    """The study of a hoisted blade."""

    name = "blade"
    stretched = ("root", 0, "position of the root, first axis (m)")
    numerics_version = add_versions(2, motion, estimation)
