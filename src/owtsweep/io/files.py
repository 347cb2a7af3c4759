"""Files that are whole or absent, whatever happens while they are written."""

from __future__ import annotations

import contextlib
import os
import re
import secrets
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path

from owtsweep.errors import InputError

#: Seconds after which a temporary file belongs to nobody any more: writing one takes far less.
STALE = 3600.0
_TEMPORARY = re.compile(r"\..+\.[0-9a-f]{16}\.tmp")


def write_atomically(path: Path, content: bytes | str) -> None:
    """Write a file so that every reader, at any moment, sees the old one or the new one.

    The content goes to a temporary name in the same folder, is flushed to the disk and renamed. An
    error leaves the old file as it was and no temporary file; a killed process may leave one
    (`.<name>.<random>.tmp`), which nothing reads. Text is written as UTF-8.

    Raises
    ------
    OSError
        If the file system refuses.
    """
    write_all({path: content})


def write_all(contents: Mapping[Path, bytes | str]) -> None:
    """Write files as `write_atomically` does, and none of them unless all fit on the disk.

    Raises
    ------
    OSError
        If the file system refuses.
    """
    temporaries: dict[Path, Path] = {}
    try:
        for path, content in contents.items():
            # Random, not the process id: machines that share a disk may share process ids.
            temporary = path.with_name(f".{path.name}.{secrets.token_hex(8)}.tmp")
            temporaries[path] = temporary
            _write_through(temporary, content.encode() if isinstance(content, str) else content)
        for path, temporary in temporaries.items():
            os.replace(temporary, path)
    except BaseException:
        for temporary in temporaries.values():
            with contextlib.suppress(OSError):
                temporary.unlink()
        raise
    for folder in {path.parent for path in contents}:
        _sync_folder(folder)


def _write_through(path: Path, data: bytes) -> None:
    with open(path, "xb") as stream:
        stream.write(data)
        stream.flush()
        os.fsync(stream.fileno())


def remove_stale(folder: Path) -> int:
    """Delete the temporary files that killed processes have left in a folder; returns how many.

    Young ones stay: another process may be writing them.
    """
    removed = 0
    now = time.time()
    for path in folder.glob(".*.tmp"):
        # A file that is gone or is not ours to delete is no reason to stop.
        with contextlib.suppress(OSError):
            if _TEMPORARY.fullmatch(path.name) and now - path.stat().st_mtime > STALE:
                path.unlink()
                removed += 1
    return removed


def _sync_folder(folder: Path) -> None:
    """Make a rename survive a power cut, where the file system knows how."""
    # The file itself is whole by now: a file system that cannot sync folders is no failure.
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def check_writable(folder: Path) -> None:
    """Make sure that files can be written in a folder, existing or not, and leave no trace.

    Raises
    ------
    InputError
        If the folder, or the nearest folder above it that exists, refuses a file.
    """
    # Not `exists`: a dangling link stands in the way of a folder too.
    nearest = folder.absolute()
    while not os.path.lexists(nearest) and nearest != nearest.parent:
        nearest = nearest.parent
    try:
        if not nearest.is_dir():
            raise NotADirectoryError(f"{nearest} is no folder")
        with tempfile.TemporaryFile(dir=nearest, prefix=".owtsweep-") as stream:
            stream.write(b"\0")
    except OSError as error:
        raise unwritable(folder, error) from error


def unwritable(folder: Path, error: OSError) -> InputError:
    """The one-line error for a results folder that the file system refuses."""
    reason = error.strerror or str(error)
    return InputError(
        f"results: {folder} cannot be written ({reason}); name another folder by results=FOLDER"
    )
