"""The outcome of a case: the `status` of its row."""

from __future__ import annotations

#: The case has a result.
OK = "ok"
#: The case failed; it is run again when the sweep is resumed.
FAILED = "failed"
#: The scheme cannot work under these conditions, for the reason given; this is its result.
UNABLE = "unable"
