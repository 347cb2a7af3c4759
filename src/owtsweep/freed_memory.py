"""Sets whether the process keeps memory that it has freed; has an effect with glibc only."""

from __future__ import annotations

import ctypes
import sys
from typing import Any

#: Parameters of `mallopt`, as in glibc's malloc.h.
_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD, _M_ARENA_MAX = -1, -3, -8
#: Arrays below this many bytes come from memory that the process keeps.
_LARGEST_KEPT = 2**30


def keep_freed_memory() -> None:
    """Make glibc keep freed memory for later use instead of returning it to the system.

    Every block of a sweep needs arrays of the same sizes as the block before it. By default glibc
    returns large arrays at once, and the system clears each page again at its next use. Clearing
    takes a tenth of the time of a sweep on one thread, and more on several. Peak memory stays that
    of the largest block. All threads share one arena (glibc's pool of memory), which holds less
    than one arena for each thread would. The setting holds for the whole process, so only
    processes that belong to a sweep should call this.
    """
    mallopt = _glibc("mallopt")
    if mallopt is None:
        return
    mallopt(_M_ARENA_MAX, 1)
    mallopt(_M_MMAP_THRESHOLD, _LARGEST_KEPT)
    mallopt(_M_TRIM_THRESHOLD, 2**31 - 1)


def give_back_freed_memory() -> None:
    """Make glibc release its kept memory to the operating system: some hundred MB per thread."""
    trim = _glibc("malloc_trim")
    if trim is not None:
        trim(0)


def _glibc(name: str) -> Any:
    """Return a function of glibc by name; return None on other systems and C libraries."""
    if sys.platform != "linux":
        return None
    return getattr(ctypes.CDLL(None), name, None)
