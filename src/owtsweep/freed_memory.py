"""What the process does with memory that it has freed. Only glibc is told anything."""

from __future__ import annotations

import ctypes
import sys
from typing import Any

#: glibc's names in malloc.h.
_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD, _M_ARENA_MAX = -1, -3, -8
#: Arrays below this many bytes come from memory that the process keeps.
_LARGEST_KEPT = 2**30


def keep_freed_memory() -> None:
    """Use freed memory again instead of giving it back to the system, where that is glibc's.

    Every block of a sweep asks for the same arrays as the block before it. glibc returns large ones
    at once, and the system clears each page again when it is next used: that takes a tenth of the
    time of a sweep on one thread, and more on several. The peak stays that of the largest block;
    one arena for all threads holds less than one for each. The setting holds for the whole process,
    so only processes that belong to a sweep should call this.
    """
    mallopt = _glibc("mallopt")
    if mallopt is None:
        return
    mallopt(_M_ARENA_MAX, 1)
    mallopt(_M_MMAP_THRESHOLD, _LARGEST_KEPT)
    mallopt(_M_TRIM_THRESHOLD, 2**31 - 1)


def give_back_freed_memory() -> None:
    """Return to the system what glibc keeps for later: some hundred MB per thread."""
    trim = _glibc("malloc_trim")
    if trim is not None:
        trim(0)


def _glibc(name: str) -> Any:
    """A function of glibc's, or None where the C library is another one."""
    if sys.platform != "linux":
        return None
    return getattr(ctypes.CDLL(None), name, None)
