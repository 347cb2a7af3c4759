"""The possible outcomes of a case, which are the values of the column `status`."""

from __future__ import annotations

#: The case has a result.
OK = "ok"
#: The case failed; it is run again when the sweep is resumed.
FAILED = "failed"
#: The scheme cannot work under these conditions, for the reason given; this is its result.
UNABLE = "unable"
