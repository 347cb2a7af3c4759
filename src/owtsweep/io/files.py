"""Write files so that they are whole or absent, even after a crash."""

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

#: Age in seconds from which a temporary file counts as abandoned: writing takes far less.
STALE = 3600.0
_TEMPORARY = re.compile(r"\..+\.[0-9a-f]{16}\.tmp")


def write_atomically(path: Path, content: bytes | str) -> None:
    """Write a file so that a reader at any moment sees either the old file or the new one.

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
    """Write several files as `write_atomically` does; if they do not all fit on the disk, none.

    Raises
    ------
    OSError
        If the file system refuses.
    """
    temporaries: dict[Path, Path] = {}
    try:
        for path, content in contents.items():
            # Random, not the process id: machines that share a disk may use the same process ids.
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


def remove_stale(folder: Path) -> None:
    """Delete temporary files left in a folder by killed processes.

    Younger files stay: another process may be writing them.
    """
    now = time.time()
    for path in folder.glob(".*.tmp"):
        # Ignore files that are gone or that this user may not delete.
        with contextlib.suppress(OSError):
            if _TEMPORARY.fullmatch(path.name) and now - path.stat().st_mtime > STALE:
                path.unlink()


def _sync_folder(folder: Path) -> None:
    """Make a rename survive a power cut, if the file system supports that."""
    # The file itself is whole already, so an error here is ignored.
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def check_writable(folder: Path) -> None:
    """Check that files can be written to a folder, which need not exist; leaves no files there.

    Raises
    ------
    InputError
        If the folder, or the nearest folder above it that exists, refuses a file.
    """
    # Not `exists`: a dangling link prevents the creation of a folder too.
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
    """The one-line error for a results folder that cannot be written."""
    reason = error.strerror or str(error)
    return InputError(
        f"results: {folder} cannot be written ({reason}); name another folder by results=FOLDER"
    )
