"""Compiles kernels with numba, and caches them so that no outdated code is used.

A kernel is a function that numba compiles; all modules with kernels import `njit` from here.
numba's own cache does not notice when a kernel calls a helper function of another file, and that
file is edited. Therefore, the name of the cache folder holds a hash of every source file that
kernels are made of. After any edit of these files, kernels are compiled into a new folder.
"""

from __future__ import annotations

import hashlib
import logging
import os
import re
import sys
import tempfile
import time
from collections.abc import Iterator
from functools import cache, partial
from pathlib import Path
from typing import Any

_PACKAGE = Path(__file__).resolve().parent
_IMPORT = re.compile(r"^ *from owtsweep\.([\w.]+) import ", re.MULTILINE)

#: The environment variable that names a command to all of its processes.
COMMAND = "OWTSWEEP_COMMAND"


@cache
def kernel_sources() -> tuple[Path, ...]:
    """Return the package's files that kernels are made of, sorted by path.

    These are the files that import this module, and all files of the package that they import,
    directly or through other files.
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
    for name in _IMPORT.findall(text):
        path = _PACKAGE.joinpath(*name.split("."))
        yield path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


@cache
def source_hash() -> str:
    import numba

    digest = hashlib.blake2b(numba.__version__.encode(), digest_size=8)
    for path in kernel_sources():
        digest.update(str(path.relative_to(_PACKAGE)).encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def cache_directory() -> Path:
    """Return the folder for compiled kernels, whose name contains `source_hash()`.

    It lies in the folder that the environment variable NUMBA_CACHE_DIR names; otherwise in the
    virtual environment that runs this process, if that can be written, or else in the user's cache
    folder.
    """
    home = os.environ.get("NUMBA_CACHE_DIR")
    if home:
        base = Path(home)
    elif sys.prefix != sys.base_prefix and os.access(sys.prefix, os.W_OK):
        base = Path(sys.prefix) / "numba-cache"  # as in the Makefile
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "owtsweep"
    return base / f"kernels-{source_hash()}"


@cache
def announce(directory: Path) -> None:
    """Log, and print to stderr once per folder and command, that kernels are being compiled."""
    text = f"compiling kernels, once (up to a minute); they are kept in {directory}"
    logging.getLogger(__name__).info(text)
    if _is_first_to_tell(directory):
        # A worker process does not know of the bar that another process draws: it erases the bar,
        # which is drawn again one line below.
        erase = "\r\x1b[K" if sys.stderr.isatty() else ""
        print(f"{erase}owtsweep: {text}", file=sys.stderr, flush=True)


def _is_first_to_tell(directory: Path) -> bool:
    """Return whether no other process of this command has told of the folder yet."""
    mine = directory / f"told-{os.environ.get(COMMAND, os.getpid())}"
    try:
        mine.touch(exist_ok=False)
    except FileExistsError:
        return False
    except OSError:  # without the folder every process tells it
        return True
    for earlier in directory.glob("told-*"):
        if earlier != mine:
            earlier.unlink(missing_ok=True)
    return True


def name_command() -> None:
    """Give this process and those that it starts a name in common, unless they have one."""
    os.environ.setdefault(COMMAND, f"{os.getpid()}-{time.time_ns()}")


@cache
def _announce_when_compiling() -> None:
    """Make numba call `announce` when it compiles a kernel, not when it reads one of the cache."""
    from numba.core import event

    class Listener(event.Listener):  # type: ignore[misc]
        def on_start(self, started: event.Event) -> None:
            if str(started.data["dispatcher"].py_func.__module__).startswith("owtsweep."):
                announce(usable_directory())

        def on_end(self, ended: event.Event) -> None:
            pass

    event.register("numba:compile", Listener())


def usable_directory() -> Path:
    """Make the folder for compiled kernels, or else one for temporary files; return its path."""
    directory = cache_directory()
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError:  # must not stop the computation
        return Path(tempfile.gettempdir()) / f"owtsweep-{directory.name}"
    return directory


def njit(function: object, **options: Any) -> Any:
    """Return a function that numba compiles when it is first called, and caches on disk.

    It runs without Python's global lock (GIL), and computes in the order of the source (no
    fastmath). `options` are further ones of numba's.
    """
    import numba

    _announce_when_compiling()
    previous = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(usable_directory())
    try:
        return numba.njit(cache=True, nogil=True, fastmath=False, error_model="numpy", **options)(
            function
        )
    finally:
        numba.config.CACHE_DIR = previous


#: For a function that only kernels call: its code becomes a part of each of them. What does not
#: change from one call to the next is then fetched once, numba counts no references to arrays on
#: the way, and no interface to Python is compiled.
part = partial(njit, forceinline=True, no_cpython_wrapper=True, no_cfunc_wrapper=True)
#: For a function whose source is pasted into kernels that call it; Python can call it, too. It is
#: for a few lines that call larger parts, which would else be optimised once more.
pasted = partial(njit, inline="always")
