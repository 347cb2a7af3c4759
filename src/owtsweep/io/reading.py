"""Reads files that other people made: regular files only, and only up to a given size."""

from __future__ import annotations

import stat
from pathlib import Path
from typing import Any

from owtsweep.errors import InputError


def require_regular(path: Path) -> None:
    """Check that a path is a regular file. (Reading a pipe could block; a device may never end.)

    Raises
    ------
    InputError
        If nothing exists at the path, the path cannot be read, or a folder, a pipe or a device is
        there.
    """
    mode = _mode(path, "file")
    if not stat.S_ISREG(mode):
        kind = "a folder" if stat.S_ISDIR(mode) else "a pipe or a device"
        raise InputError(f"{path}: this is {kind}; name a file")


def require_folder(path: Path) -> None:
    """Check that a path is a folder.

    Raises
    ------
    InputError
        If nothing exists at the path, the path cannot be read, or something other than a folder is
        there.
    """
    if not stat.S_ISDIR(_mode(path, "folder")):
        raise InputError(f"{path}: this is a file; name a folder")


def _mode(path: Path, kind: str) -> int:
    try:
        return path.stat().st_mode
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such {kind}") from None
    except (OSError, ValueError) as error:  # ValueError: a null character in its name
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(f"{path}: cannot be read ({reason})") from error


def read_bytes(path: Path, most: int) -> bytes:
    """Read a file of at most `most` bytes; return its content.

    Raises
    ------
    InputError
        If the path is no regular file, or the file cannot be read or is larger than `most` bytes.
    """
    require_regular(path)
    try:
        with path.open("rb") as stream:
            # Not `most`: read reserves what it is asked for.
            data = stream.read(min(path.stat().st_size, most) + 1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    if len(data) > most:
        raise InputError(f"{path}: it is larger than {most / 1e6:g} MB; is this the right file?")
    return data


def read_text(path: Path, most: int) -> str:
    """Read a UTF-8 file of at most `most` bytes; return its text.

    Raises
    ------
    InputError
        If the path is no regular file, or the file cannot be read, is larger than `most` bytes, or
        is no text in UTF-8.
    """
    try:
        return read_bytes(path, most).decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: this is no text in UTF-8 ({error.reason})") from error


def read_json(path: Path, most: int) -> Any:
    """Read a JSON file of at most `most` bytes; return its data, which may be of any type.

    Raises
    ------
    InputError
        If the file is refused as by `read_text`, if the text is no JSON, or if the data nest too
        deeply for Python's parser.
    """
    import json

    text = read_text(path, most)
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        reason = "it nests too deeply" if isinstance(error, RecursionError) else str(error)
        raise InputError(f"{path}: this is no JSON ({reason})") from None
