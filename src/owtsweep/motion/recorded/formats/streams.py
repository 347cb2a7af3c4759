"""Read the bytes of a text file, unpacked, unless they or a line are too many."""

from __future__ import annotations

import gzip
import math
import zlib
from collections.abc import Iterator
from pathlib import Path

from owtsweep.errors import require
from owtsweep.io.reading import require_regular
from owtsweep.motion.recorded.formats.table import refuse_damaged

#: Most bytes of a line, and the number of bytes that are read at once.
BLOCK = 1 << 22
#: Bytes at the end of a file that are one block: what follows the rows of a table is among them.
TAIL = 1 << 16
#: A compressed file may unpack to `MOST_UNPACKED` bytes, or to `MOST_TIMES` times its size if that
#: is more.
MOST_UNPACKED, MOST_TIMES = 150_000_000, 50


def read_chunks(path: Path, size: int) -> Iterator[bytes]:
    """Yield the bytes of a text file, `size` at a time, unpacked if the file's name ends in .gz.

    Raises InputError if the path is no regular file, the file is damaged, unpacks to too many
        bytes, or has a line of more than `BLOCK` bytes, for which a parser might need any amount of
        memory.
    """
    require_regular(path)
    packed = path.suffix.lower() == ".gz"
    left = max(MOST_UNPACKED, MOST_TIMES * path.stat().st_size) if packed else math.inf
    line = 0
    with (
        refuse_damaged(path, "cannot be read", OSError, EOFError, zlib.error),
        gzip.open(path) if packed else path.open("rb") as source,
    ):
        while chunk := source.read(size):
            left -= len(chunk)
            require(
                left >= 0,
                f"{path}: unpacks to more than {MOST_UNPACKED / 1e6:g} MB and {MOST_TIMES} times "
                "its size; unpack it yourself if you trust it",
            )
            end = max(chunk.rfind(b"\n"), chunk.rfind(b"\r"))
            line = line + len(chunk) if end < 0 else len(chunk) - end - 1
            require(
                line <= BLOCK,
                f"{path}: has a line of more than {BLOCK >> 20} MB; is this a text table?",
            )
            yield chunk


def read_blocks(path: Path) -> Iterator[tuple[bytes, bool]]:
    """Yield a text file in blocks of whole lines, about `BLOCK` bytes, and whether it is the last.

    The last one holds the last `TAIL` bytes or the whole file; its last line may have no end.
    """
    rest = b""
    for chunk in read_chunks(path, BLOCK):
        rest += chunk
        most = max(len(rest) - TAIL, 0)
        end = max(rest.rfind(b"\n", 0, most), rest.rfind(b"\r", 0, most)) + 1
        if end:
            yield rest[:end], False
            rest = rest[end:]
    yield rest, True
