"""Sets what concerns the whole process: memory that it has freed, and where workers find modules.

What concerns memory works only with glibc, the C library of most Linux systems. Elsewhere nothing
happens.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

#: Parameters of `mallopt`, as in glibc's malloc.h.
_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD, _M_ARENA_MAX = -1, -3, -8
#: Arrays below this many bytes come from memory that the process keeps.
_LARGEST_KEPT = 2**30
#: The environment variable by which Python leaves the current folder off its search path, as -P.
_VARIABLE = "PYTHONSAFEPATH"


def keep_freed_memory() -> None:
    """Make glibc keep freed memory for later use instead of returning it to the system.

    A sweep computes blocks one after the other, with arrays of the same sizes. By default, glibc
    returns large arrays to the system at once, and the system clears each page of memory at its
    next use. Clearing takes a tenth of the time of a sweep on one thread, and more on several
    threads. The peak of memory use remains that of the largest block. All threads share one arena
    (a pool of memory in glibc), because one for each thread would keep more memory.

    The setting holds for the whole process, so only processes of a sweep should call this function.
    """
    _call_glibc("mallopt", _M_ARENA_MAX, 1)
    _call_glibc("mallopt", _M_MMAP_THRESHOLD, _LARGEST_KEPT)
    _call_glibc("mallopt", _M_TRIM_THRESHOLD, 2**31 - 1)


def give_back_freed_memory() -> None:
    """Make glibc return the memory that it has kept to the system: some hundred MB per thread."""
    _call_glibc("malloc_trim", 0)


def _call_glibc(name: str, *arguments: int) -> None:
    """Call the function `name` of the C library; do nothing if it has none, or not on Linux."""
    if sys.platform == "linux":
        with suppress(AttributeError):
            getattr(ctypes.CDLL(None), name)(*arguments)


@contextmanager
def no_modules_of_this_folder() -> Iterator[None]:
    """Let processes that are started inside the context import nothing from the current folder.

    joblib and Hydra's launchers start their workers by `python -m` and `python -c`, which search
    the current folder first: a file joblib.py there, perhaps a stranger's, would be run. Folders of
    PYTHONPATH are searched as ever. If this process itself searches the current folder (`python -m
    owtsweep`), so do its workers, and nothing is changed.
    """
    before = os.environ.get(_VARIABLE)
    here = os.getcwd()
    if before or any(os.path.abspath(folder) == here for folder in sys.path):
        yield
        return
    os.environ[_VARIABLE] = "1"
    try:
        yield
    finally:
        if before is None:
            os.environ.pop(_VARIABLE, None)
        else:
            os.environ[_VARIABLE] = before
