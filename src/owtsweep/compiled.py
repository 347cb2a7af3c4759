"""Compiles kernels with numba and caches them so that no stale code is used.

A kernel is a function compiled by numba; all kernels import `njit` from here. numba's own cache
does not notice edits in helper functions of other files. The cache folder is therefore named by a
hash of every source file that kernels are made of: after any edit, kernels use a new folder.
"""

from __future__ import annotations

import hashlib
import logging
import os
import re
import sys
import tempfile
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

_PACKAGE = Path(__file__).resolve().parent
_IMPORT = re.compile(r"^ *from owtsweep\.([\w.]+) import ", re.MULTILINE)

#: The end of the cache folder's name, for all kernels that are imported from now on.
variant = ""


@cache
def kernel_sources() -> tuple[Path, ...]:
    """Return the package's files that kernels are made of, sorted by path.

    These are the files that import this module, and all files of the package that they import,
    directly or through others.
    """
    texts = {path: path.read_text("utf-8") for path in _PACKAGE.rglob("*.py")}
    todo = [p for p, text in texts.items() if Path(__file__).resolve() in _imported(text)]
    sources: set[Path] = set()
    while todo:
        path = todo.pop()
        if path not in sources:
            sources.add(path)
            todo += _imported(texts[path])
    return tuple(sorted(sources))


def _imported(text: str) -> Iterator[Path]:
    """Yield the files of this package that a source text imports from."""
    for name in _IMPORT.findall(text):
        path = _PACKAGE.joinpath(*name.split("."))
        yield path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


@cache
def source_hash() -> str:
    """Return a hash of all kernel sources and of numba's version, in hexadecimal digits."""
    import numba

    digest = hashlib.blake2b(numba.__version__.encode(), digest_size=8)
    for path in kernel_sources():
        digest.update(str(path.relative_to(_PACKAGE)).encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def cache_directory() -> Path:
    """Return the folder of compiled kernels, whose name contains `source_hash`.

    The folder lies in NUMBA_CACHE_DIR if that variable is set; else in the virtual environment that
    runs this process, if there is one and it can be written; else in the user's cache folder.
    """
    home = os.environ.get("NUMBA_CACHE_DIR")
    if home:
        base = Path(home)
    elif sys.prefix != sys.base_prefix and os.access(sys.prefix, os.W_OK):
        base = Path(sys.prefix) / "numba-cache"  # as in the Makefile
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "owtsweep"
    return base / f"kernels-{source_hash()}{variant}"


@cache
def announce(directory: Path) -> None:
    """Log and print to stderr, once per folder, that kernels are being compiled into the folder."""
    text = f"compiling kernels, once (up to a minute); they are kept in {directory}"
    logging.getLogger(__name__).info(text)
    print(f"owtsweep: {text}", file=sys.stderr)


@cache
def _announce_when_compiling() -> None:
    """Make numba call `announce` whenever it compiles a kernel of this package.

    Reading a kernel from the cache does not count.
    """
    from numba.core import event

    class Listener(event.Listener):  # type: ignore[misc]
        def on_start(self, started: Any) -> None:
            if str(started.data["dispatcher"].py_func.__module__).startswith("owtsweep."):
                announce(usable_directory())

        def on_end(self, ended: Any) -> None:
            pass

    event.register("numba:compile", Listener())


def usable_directory() -> Path:
    """Make the cache folder and return it; if that fails, return one among the temporary files."""
    directory = cache_directory()
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError:  # must not stop the computation
        return Path(tempfile.gettempdir()) / f"owtsweep-{directory.name}"
    return directory


def njit(function: Callable[..., Any]) -> Any:
    """Compile a function by `numba.njit`: cached, without the GIL, exact (no fastmath)."""
    import numba

    _announce_when_compiling()
    previous = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(usable_directory())
    try:
        return numba.njit(cache=True, nogil=True, fastmath=False, error_model="numpy")(function)
    finally:
        numba.config.CACHE_DIR = previous
