"""Caches results that take seconds to compute, in memory and in the user's cache folder.

A file's name is a hash of everything that its numbers depend on, including this program's source.
So an edited program never reads old numbers. If a file is damaged, its numbers are computed again.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import os
import threading
from collections.abc import Callable, Hashable, Mapping
from functools import cache, lru_cache
from pathlib import Path
from typing import Generic, TypeVar

import numpy as np

from owtsweep.arrays import Array
from owtsweep.io.files import write_atomically

V = TypeVar("V")


class Kept(Generic[V]):
    """The values in memory that were used last, by key, at most so many of them."""

    def __init__(self, most: int) -> None:
        # of each key a lock, which whoever makes the value holds, and the value once it is made
        self._find = lru_cache(most)(lambda key: (threading.Lock(), list[V]()))
        self.clear = self._find.cache_clear

    def find(self, key: Hashable, make: Callable[[], V]) -> V:
        """Return the value of a key, which is made once: threads that need the same one wait."""
        lock, made = self._find(key)
        with lock:
            if not made:
                made.append(make())
            return made[0]


#: The cache in memory. The cache folder has no limit; the user may empty it.
KEPT: Kept[dict[str, Array]] = Kept(64)


def folder() -> Path:
    """Return the folder of the cached files: owtsweep/expected in $XDG_CACHE_HOME or ~/.cache."""
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "owtsweep" / "expected"


def cached(what: Mapping[str, object], compute: Callable[[], dict[str, Array]]) -> dict[str, Array]:
    """Return arrays by name: from memory, else from a file, else computed and then stored.

    `what` is all that they depend on besides this program; it must be JSON-serialisable.
    """
    text = json.dumps({**what, "source": source_hash()}, sort_keys=True, default=str)
    key = hashlib.blake2b(text.encode(), digest_size=16).hexdigest()
    path = folder() / f"{key}.npz"

    def recall() -> dict[str, Array]:
        arrays = _read(path)
        if arrays is None:
            arrays = compute()
            _write(path, arrays)
        return arrays

    return KEPT.find(key, recall)


def _read(path: Path) -> dict[str, Array] | None:
    try:
        data = path.read_bytes()
        digest, body = data[:16], data[16:]
        if hashlib.blake2b(body, digest_size=16).digest() != digest:
            return None
        with np.load(io.BytesIO(body), allow_pickle=False) as stored:
            return {name: stored[name] for name in stored.files}
    except (OSError, ValueError, KeyError):
        return None


def _write(path: Path, arrays: Mapping[str, Array]) -> None:
    buffer = io.BytesIO()
    np.savez(buffer, **dict(arrays))  # type: ignore[arg-type]
    body = buffer.getvalue()
    # a folder that cannot be written must not prevent the computation
    with contextlib.suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, hashlib.blake2b(body, digest_size=16).digest() + body)


@cache
def source_hash() -> str:
    """Return a hash of the package's code, and of the versions of NumPy and SciPy."""
    import scipy

    package = Path(__file__).resolve().parents[1]
    digest = hashlib.blake2b(f"{np.__version__} {scipy.__version__}".encode(), digest_size=8)
    for file in sorted(package.rglob("*.py")):
        digest.update(str(file.relative_to(package)).encode())
        digest.update(file.read_bytes())
    return digest.hexdigest()
