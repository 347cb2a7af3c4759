"""numba, set up so that compiled code is cached and never stale.

numba's own cache does not see edits in helper functions of other files. The cache folder is
therefore named by a hash of every source file that holds kernels: an edit anywhere means a new
folder. Kernels import `njit` from here.
"""

from __future__ import annotations

import hashlib
import logging
import os
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

KERNEL_SOURCES = (
    "estimation/riccati.py",
    "estimation/windowing.py",
    "vectors",
    "studies/hub/kernels",
    "studies/hub/expected/kernels.py",
)


def source_hash() -> str:
    """Hash of all kernel sources and of the numba that compiles them."""
    import numba

    package = Path(__file__).resolve().parent
    digest = hashlib.blake2b(numba.__version__.encode(), digest_size=8)
    for entry in (*KERNEL_SOURCES, "compiled.py"):
        path = package / entry
        for file in sorted(path.glob("*.py")) if path.is_dir() else [path]:
            digest.update(file.name.encode())
            digest.update(file.read_bytes())
    return digest.hexdigest()


def cache_directory() -> Path:
    """Where compiled kernels are kept: NUMBA_CACHE_DIR if set, else the user's cache folder."""
    home = os.environ.get("NUMBA_CACHE_DIR")
    if home:
        base = Path(home)
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "owtsweep"
    return base / f"kernels-{source_hash()}"


@cache
def announce(directory: Path) -> None:
    """Say once that there is nothing compiled yet: the first run takes longer than all others."""
    if any(directory.rglob("*.nbi")):
        return
    text = f"compiling kernels, once (some 30 s); they are kept in {directory}"
    logging.getLogger(__name__).info(text)
    print(f"owtsweep: {text}", file=sys.stderr)


def _set_cache_directory() -> None:
    import numba

    directory = cache_directory()
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError:  # a home that cannot be written must not stop anybody from computing
        directory = Path(tempfile.gettempdir()) / f"owtsweep-kernels-{source_hash()}"
    announce(directory)
    numba.config.CACHE_DIR = str(directory)


def njit(function: Callable[..., Any]) -> Any:
    """`numba.njit` as this package uses it: cached, without the GIL, exact (no fastmath)."""
    import numba

    previous = numba.config.CACHE_DIR
    _set_cache_directory()
    try:
        return numba.njit(cache=True, nogil=True, fastmath=False, error_model="numpy")(function)
    finally:
        numba.config.CACHE_DIR = previous
