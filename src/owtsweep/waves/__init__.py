"""Irregular waves and their loads on a vertical cylinder.

Waves are linear and travel in one direction. Heights are in m above the still water line.
"""

from owtsweep.waves.sea import Cylinder, Sea, Waves, drag_force, draw_waves, inertia_force

#: Raised when a number that this room computes changes.
NUMERICS_VERSION = 0

__all__ = ["Cylinder", "Sea", "Waves", "drag_force", "draw_waves", "inertia_force"]
