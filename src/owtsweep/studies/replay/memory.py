"""Memory that is free goes back to the system."""

from __future__ import annotations

from owtsweep.freed_memory import give_back_freed_memory
from owtsweep.studies.replay.record import Record

#: Steps beyond which a record is long: its memory is watched, and what takes its time is told.
LONG = 1_000_000


def give_back(record: Record) -> None:
    """After work on a long record, whose pieces need arrays of some MB by the dozen."""
    if record.steps > LONG:
        give_back_freed_memory()
