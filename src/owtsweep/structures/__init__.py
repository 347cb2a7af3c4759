"""Beam models of wind turbines' support structures: from a description to modes.

Structures are beams in a plane, so a symmetric structure moves alike in every horizontal direction.
Heights are in m above mean sea level, positive upwards.
"""

from owtsweep.structures.description import Structure, find_structure, read_structure
from owtsweep.structures.modes import Modes, compute_modes

#: Raised when a number that this room computes changes.
NUMERICS_VERSION = 0

__all__ = ["Modes", "Structure", "compute_modes", "find_structure", "read_structure"]
