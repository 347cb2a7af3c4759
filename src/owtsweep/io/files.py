"""Writes files so that they are whole or absent, even after a crash."""

from __future__ import annotations

import contextlib
import errno
import os
import re
import secrets
import tempfile
import time
from collections.abc import Iterator, Mapping
from pathlib import Path

from owtsweep.errors import InputError

#: Age in seconds from which a temporary file counts as abandoned: writing takes far less.
STALE = 3600.0
#: ROOM: a folder's path must be so short that file names of this many characters still fit below.
#: MOST_NEW: most missing folders above a file; the standard library makes folders by recursion.
ROOM = 120
MOST_NEW = 100
_TEMPORARY = re.compile(r"\..+\.[0-9a-f]{16}\.tmp")


def write_atomically(path: Path, content: bytes | str) -> None:
    """Write a file so that a reader at any moment sees either the old content or the new one.

    A temporary file in the same folder is written, flushed to the disk and renamed to `path`. After
    an error, the old file is unchanged and the temporary file is gone. A killed process may leave a
    temporary file (`.<name>.<random>.tmp`), which nothing reads. Text is written as UTF-8. Raise
    `OSError` if the file cannot be written.
    """
    write_all({path: content})


def write_all(contents: Mapping[Path, bytes | str]) -> None:
    """Write several files; a reader sees either the old or the new content of each file.

    Temporary files are written first, and renamed when all are there. So if the contents do not all
    fit on the disk, no file is changed. Text is written as UTF-8. Raise `OSError` if the file
    system refuses a file. The error's first note (`__notes__`) names the file.
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
    except BaseException as error:
        if isinstance(error, OSError):
            error.add_note(str(path))  # the error itself has the temporary name, or none
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
    """Delete the temporary files of `write_atomically` in a folder that are older than one hour.

    Killed processes have left them. Another process may still be writing younger ones.
    """
    now = time.time()
    for path in folder.glob(".*.tmp"):
        # Ignore files that are gone or that this user may not delete.
        with contextlib.suppress(OSError):
            if _TEMPORARY.fullmatch(path.name) and now - path.stat().st_mtime > STALE:
                path.unlink()


def _sync_folder(folder: Path) -> None:
    """Flush a folder's list of files to the disk, so that new names survive a power cut."""
    # The files themselves are whole already, so an error here is ignored.
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


#: Advice to a user whose results folder cannot be written.
ELSEWHERE = "name another folder by results=FOLDER"


def check_writable(folder: Path, argument: str = "results", remedy: str = ELSEWHERE) -> None:
    """Check that a file can be created in a folder, or in the nearest existing one above it.

    Raise `InputError` if no file can be created, the path is too long, or more than `MOST_NEW`
    folders would have to be made. The message begins with `argument`, the setting that holds the
    folder, and ends with `remedy`, the advice to the user.
    """
    # Not `exists`: a dangling link prevents the creation of a folder too.
    nearest, missing = folder.absolute(), 0
    while not os.path.lexists(nearest) and nearest != nearest.parent:
        nearest, missing = nearest.parent, missing + 1
    try:
        if missing > MOST_NEW:
            raise OSError(f"{missing} folders, one in the other, would have to be made")
        if not nearest.is_dir():
            raise NotADirectoryError(f"{nearest} is no folder")
        with contextlib.suppress(FileNotFoundError):
            os.lstat(folder.absolute() / ("x" * ROOM))  # refused if it is too long
        with tempfile.TemporaryFile(dir=nearest, prefix=".owtsweep-") as stream:
            stream.write(b"\0")
    except OSError as error:
        raise unwritable(folder, error, argument, remedy) from error


@contextlib.contextmanager
def refuse_in_one_line(folder: Path) -> Iterator[None]:
    """Turn an error of the file system inside the context into an InputError of one line.

    It names the file, or `folder` if the file is not known. An `OSError` for too many open files is
    passed on, because no file is at fault.
    """
    try:
        yield
    except OSError as error:
        if error.errno in (errno.EMFILE, errno.ENFILE):
            raise
        raise InputError(f"{name_refusal(error, folder)}; see to that, then try again") from error


def name_refusal(error: OSError, folder: Path) -> str:
    """Return a text with the file that could not be written, and the reason.

    The file is the one in the note of `write_all`, else the one in the error, else `folder`.
    """
    notes = getattr(error, "__notes__", [])
    refused = notes[0] if notes else error.filename or folder
    return f"{refused}: cannot be written ({error.strerror or error})"


def unwritable(
    folder: Path, error: OSError, argument: str = "results", remedy: str = ELSEWHERE
) -> InputError:
    """Return (not raise) the one-line InputError for a folder that cannot be written.

    It has `argument`, the name of the setting that holds the folder, then the folder (at most 200
    characters), the reason of `error`, and `remedy`, the advice to the user.
    """
    reason = error.strerror or str(error)
    shown = str(folder) if len(str(folder)) <= 200 else f"{str(folder)[:200]}..."
    return InputError(f"{argument}: {shown} cannot be written ({reason}); {remedy}")
