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
    """Write a file so that a reader at any moment sees either the old content or the new one.

    The content is written to a temporary file in the same folder, flushed to the disk, and the file
    is renamed. After an error, the old file is unchanged and the temporary file is gone. A killed
    process may leave a temporary file (`.<name>.<random>.tmp`), which nothing reads. Text is
    written as UTF-8.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    write_all({path: content})


def write_all(contents: Mapping[Path, bytes | str]) -> None:
    """Write several files as `write_atomically` does, by path; if the disk gets full, write none.

    Raises
    ------
    OSError
        If a file cannot be written.
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
    """Delete temporary files older than an hour, which killed processes have left in a folder.

    Younger temporary files stay, because another process may be writing them.
    """
    now = time.time()
    for path in folder.glob(".*.tmp"):
        # Ignore files that are gone or that this user may not delete.
        with contextlib.suppress(OSError):
            if _TEMPORARY.fullmatch(path.name) and now - path.stat().st_mtime > STALE:
                path.unlink()


def _sync_folder(folder: Path) -> None:
    """Flush a folder to the disk, so that renamed files in it survive a power cut.

    If the file system does not support this, nothing happens.
    """
    # The file itself is whole already, so an error here is ignored.
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def check_writable(folder: Path) -> None:
    """Check that a file can be created in a folder, and leave no file there.

    If the folder does not exist, the nearest existing folder above it is checked.

    Raises
    ------
    InputError
        If no file can be created.
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
    """Make the one-line error for a results folder that cannot be written, from the cause."""
    reason = error.strerror or str(error)
    return InputError(
        f"results: {folder} cannot be written ({reason}); name another folder by results=FOLDER"
    )
