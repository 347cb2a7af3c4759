"""Read recordings of motion and of sensors, check them, and resample them to a uniform grid."""

from owtsweep.motion.recorded.choosing import MotionKind
from owtsweep.motion.recorded.composing import Rotation
from owtsweep.motion.recorded.deriving import MOTION_CUTOFF, find_clear_band, to_motion
from owtsweep.motion.recorded.describing import describe, tell_alone
from owtsweep.motion.recorded.formats import open_table
from owtsweep.motion.recorded.gridding import Gridded, TimeGrid, find_common_grid, to_grid
from owtsweep.motion.recorded.reading import read
from owtsweep.motion.recorded.recording import Recording
from owtsweep.motion.recorded.signals import Signals, Wanted, read_signals

__all__ = [
    "MOTION_CUTOFF",
    "Gridded",
    "MotionKind",
    "Recording",
    "Rotation",
    "Signals",
    "TimeGrid",
    "Wanted",
    "describe",
    "find_clear_band",
    "find_common_grid",
    "open_table",
    "read",
    "read_signals",
    "tell_alone",
    "to_grid",
    "to_motion",
]
