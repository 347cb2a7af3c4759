"""Special treatment of long records."""

from __future__ import annotations

from owtsweep.freed_memory import give_back_freed_memory
from owtsweep.studies.replay.record import ReplayRecord

#: Steps beyond which a record is long: its memory is watched, and slow work is announced.
LONG = 1_000_000


def release_memory(record: ReplayRecord) -> None:
    """Return freed memory (some 100 MB) to the system after the pieces of a long record."""
    if record.steps > LONG:
        give_back_freed_memory()
