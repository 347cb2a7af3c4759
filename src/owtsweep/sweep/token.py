"""Whether a machine elsewhere sees the run folder: only then can it read the token in there."""

from __future__ import annotations

import contextlib
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def shared_token(folder: Path) -> Iterator[str | None]:
    """The name of a file in the run folder that exists while the context is open.

    The name is random: a folder of the same path on another machine does not have it. None if the
    file cannot be written; then workers hand their shards back.
    """
    # The form of a temporary file: one that a killed sweep leaves is cleaned up with those.
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
