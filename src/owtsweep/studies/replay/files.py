"""Gives files of records labels, hashes, and names for titles."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

from owtsweep.errors import InputError, printable
from owtsweep.io.reading import require_regular

#: The number of characters that fit into a title.
LONGEST = 80


def label_files(files: Sequence[str]) -> dict[str, str]:
    """Return label -> file, in order: the file's name without extensions, or numbered."""
    labels: dict[str, str] = {}
    for file in files:
        stem = printable(Path(file).name.split(".")[0] or Path(file).name)
        label, number = stem, 2
        while label in labels:
            label, number = f"{stem}-{number}", number + 1
        labels[label] = file
    return labels


def hash_file(file: str) -> str:
    """Return the hash of a file's contents; NAME.sel and NAME.dat of HAWC2 share one hash."""
    path = Path(file)
    try:
        parts = [path]
        if path.suffix.lower() in (".sel", ".dat"):
            parts = [p for p in (path.with_suffix(".sel"), path.with_suffix(".dat")) if p.exists()]
        for part in parts:
            require_regular(part)
        states = tuple((str(p), p.stat().st_size, p.stat().st_mtime_ns) for p in parts)
        return _hash(states)
    except OSError as error:
        raise InputError(f"{file}: cannot be read ({error.strerror or error})") from error


def may_read(file: str) -> bool:
    """Return False if a file is there but its permissions do not let this process read it."""
    return os.access(file, os.R_OK) or not os.path.exists(file)


@lru_cache(maxsize=4096)
def _hash(states: tuple[tuple[str, int, int], ...]) -> str:
    result = hashlib.blake2b(digest_size=16)
    for name, _, _ in states:
        with open(name, "rb") as stream:
            while chunk := stream.read(1 << 20):
                result.update(chunk)
    return result.hexdigest()


def as_plain(text: str) -> str:
    """Return a text that matplotlib draws as it is, without reading a part as a formula."""
    return printable(text).replace("$", r"\$")


def name_file(path: str) -> str:
    """Return the name of the file at `path` for a title, cut to `LONGEST` characters."""
    name = Path(path).name
    return as_plain(name if len(name) <= LONGEST else f"{name[:LONGEST]}...")
