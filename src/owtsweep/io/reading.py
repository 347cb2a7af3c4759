"""Reads files that other people made: regular files only, and only up to a given size."""

from __future__ import annotations

import errno
import hashlib
import os
import stat
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

from owtsweep.errors import InputError

T = TypeVar("T")

#: A file above this many bytes is read only if it has no holes, which claim bytes without a cost.
MOST_SPARSE = 100_000_000


def expand_home(path: str) -> Path:
    """Return the path with the user's home folder in place of `~`; `~nobody` stays as it is."""
    return Path(os.path.expanduser(path))  # `Path.expanduser` raises for an unknown user


def require_regular(path: Path, *, links: bool = True) -> None:
    """Check that a path is a regular file. (Reading a pipe could block; a device may never end.)

    Raise `InputError` if nothing is there, it cannot be read, or is a folder, a pipe or a device;
    without `links` also if it is a link.
    """
    mode = _mode(path, "file")
    if not links and path.is_symlink():
        raise InputError(f"{path}: this is a link where a file belongs; move it away")
    if not stat.S_ISREG(mode):
        kind = "a folder" if stat.S_ISDIR(mode) else "a pipe or a device"
        raise InputError(f"{path}: this is {kind}; name a file")


def require_folder(path: Path) -> None:
    """Raise `InputError` unless a path is a folder that can be read."""
    if not stat.S_ISDIR(_mode(path, "folder")):
        raise InputError(f"{path}: this is a file; name a folder")


def refuse_links(folder: Path, *, but: Collection[str] = (), deep: bool = True) -> None:
    """Check that nothing in a folder is a link, whose target a command would read or write.

    Raise `InputError` if a link is there, or a folder cannot be read.

    `folder`: the folder of a run, or of several; it may be a link itself, and need not exist.
    `but`: names of subfolders whose content is not looked at. `deep`: whether to look into
    subfolders.
    """

    def refuse(error: OSError) -> None:
        if error.errno not in (errno.ENOENT, errno.ENOTDIR, errno.ENAMETOOLONG):  # nothing is there
            raise InputError(f"{folder}: cannot be read ({error.strerror})") from error

    for top, folders, files in os.walk(folder, onerror=refuse):
        for path in sorted(Path(top, name) for name in (*folders, *files)):
            if path.is_symlink():
                kind = "file" if path.suffix else "folder"
                raise InputError(f"{path}: this is a link where a {kind} belongs; move it away")
        folders[:] = [name for name in folders if deep and name not in but]


def _mode(path: Path, kind: str) -> int:
    try:
        return path.stat().st_mode
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such {kind}") from None
    except (OSError, ValueError) as error:  # ValueError: a null character in its name
        reason = (isinstance(error, OSError) and error.strerror) or str(error)
        raise InputError(f"{path}: cannot be read ({reason})") from error


@contextmanager
def refuse_unreadable(path: Path) -> Iterator[None]:
    """Turn an error of the file system inside a `with` block into an `InputError` with the path."""
    try:
        yield
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error


def read_bytes(path: Path, most: int, *, links: bool = True) -> bytes:
    """Read a file of at most `most` bytes; return its content.

    Raise `InputError` if the path is no regular file (or a link, without `links`), or the file
    cannot be read, is larger than `most` bytes, or has holes and more than `MOST_SPARSE` bytes.
    Nothing has been read then.
    """
    require_regular(path, links=links)
    with refuse_unreadable(path), path.open("rb") as stream:
        size = os.fstat(stream.fileno()).st_size
        _require_size(path, size, most)
        if size > MOST_SPARSE and _has_hole(stream.fileno(), size):
            raise InputError(f"{path}: its {size / 1e6:.0f} MB have holes; is this the right file?")
        data = stream.read(size + 1)  # not `most`: read reserves what it is asked for
    _require_size(path, len(data), most)  # it may have grown
    return data


def _require_size(path: Path, size: int, most: int) -> None:
    if size > most:
        raise InputError(f"{path}: it is larger than {most / 1e6:g} MB; is this the right file?")


def _has_hole(descriptor: int, size: int) -> bool:
    """Return whether an open file has a hole; False where the system cannot say."""
    try:
        hole = os.lseek(descriptor, 0, os.SEEK_HOLE) < size
    except (OSError, AttributeError):
        hole = False
    os.lseek(descriptor, 0, os.SEEK_SET)
    return hole


def hash_file(path: Path) -> str:
    """Return the hash of a file's bytes: 32 hexadecimal digits.

    Raise `InputError` if the path is no regular file, or the file cannot be read.
    """
    require_regular(path)
    with refuse_unreadable(path), path.open("rb") as stream:
        return hashlib.file_digest(stream, lambda: hashlib.blake2b(digest_size=16)).hexdigest()


def read_text(path: Path, most: int) -> str:
    """Read a UTF-8 file of at most `most` bytes; return its text.

    Raise `InputError` as `read_bytes` does, or if it is no text in UTF-8.
    """
    try:
        return read_bytes(path, most).decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: this is no text in UTF-8 ({error.reason})") from error


def read_json(path: Path, most: int) -> object:
    """Read a JSON file of at most `most` bytes; return its data, which may be of any type.

    Raise `InputError` as `read_text` does, or if it is no JSON or nests too deeply for the parser.
    """
    import json

    text = read_text(path, most)
    try:
        data: object = json.loads(text)
    except (ValueError, RecursionError) as error:
        reason = "it nests too deeply" if isinstance(error, RecursionError) else str(error)
        raise InputError(f"{path}: this is no JSON ({reason})") from None
    return data


def read_as(kind: type[T], path: Path, most: int, refusal: str) -> T:
    """Read a JSON file of at most `most` bytes as an object of a type, such as a dataclass.

    Raise `InputError` as `read_text` does; or with `refusal` after the path, if the file holds
    anything else.
    """
    import json

    from pydantic import TypeAdapter

    text = read_text(path, most)
    try:  # not `validate_json`, which refuses file names that are no Unicode
        return TypeAdapter(kind).validate_python(json.loads(text))
    except (ValueError, RecursionError):
        raise InputError(f"{path}: {refusal}") from None
