"""Memory that is free goes back to the system."""

from __future__ import annotations

import ctypes
import sys

from owtsweep.studies.replay.record import Record

#: Steps beyond which a record is long: its memory is watched, and what takes its time is told.
LONG = 1_000_000


def give_back(record: Record) -> None:
    """After work on a long record: let glibc return what it keeps for later; others do it anyway.

    Arrays of some MB, which a piece of a record needs by the dozen, otherwise stay with the process
    when they are freed: some hundred MB per thread.
    """
    if record.steps > LONG and sys.platform == "linux":
        trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
        if trim is not None:
            trim(0)
