"""A token file in the run folder: a machine that finds it shares the folder."""

from __future__ import annotations

import contextlib
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def shared_token(folder: Path) -> Iterator[str | None]:
    """The name of a file in the run folder that exists while the context is open.

    The name is random, so a folder with the same path on another machine does not contain it. The
    name is None if the file cannot be written; then workers send their shards back.
    """
    # Named like a temporary file, so that one left by a killed sweep is cleaned up too.
    path = folder / f".shared.{secrets.token_hex(8)}.tmp"
    try:
        path.touch(exist_ok=False)
    except OSError:
        yield None
        return
    try:
        yield path.name
    finally:
        with contextlib.suppress(OSError):
            path.unlink()
