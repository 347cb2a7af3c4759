"""Read the bytes of a text file, unpacked, unless they or a line are too many."""

from __future__ import annotations

import gzip
import io
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


class TextStream(io.RawIOBase):
    """The bytes of a text file, unpacked if the file's name ends in .gz.

    Reading raises `InputError` if the file is damaged, unpacks to too many bytes, or has a line of
    more than `BLOCK` bytes, for which a parser might need any amount of memory.
    """

    def __init__(self, path: Path) -> None:
        super().__init__()
        require_regular(path)
        packed = path.suffix.lower() == ".gz"
        self._path = path
        self._source = gzip.open(path) if packed else path.open("rb")  # noqa: SIM115
        size = path.stat().st_size
        self._left = max(MOST_UNPACKED, MOST_TIMES * size) if packed else math.inf
        self._line = 0

    def readable(self) -> bool:
        """Return True; pandas asks."""
        return True

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        """Write the next bytes into a buffer; return their number, 0 at the end of the file."""
        with refuse_damaged(self._path, "cannot be read", OSError, EOFError, zlib.error):
            chunk = self._source.read(len(buffer))
        self._left -= len(chunk)
        require(
            self._left >= 0,
            f"{self._path}: unpacks to more than {MOST_UNPACKED / 1e6:g} MB and {MOST_TIMES} times "
            "its size; unpack it yourself if you trust it",
        )
        end = max(chunk.rfind(b"\n"), chunk.rfind(b"\r"))
        self._line = self._line + len(chunk) if end < 0 else len(chunk) - end - 1
        require(
            self._line <= BLOCK,
            f"{self._path}: has a line of more than {BLOCK >> 20} MB; is this a text table?",
        )
        buffer[: len(chunk)] = chunk
        return len(chunk)

    def close(self) -> None:
        """Close the file and the stream."""
        self._source.close()
        super().close()


def read_blocks(path: Path) -> Iterator[tuple[bytes, bool]]:
    """Yield a text file in blocks of whole lines, about `BLOCK` bytes, and whether it is the last.

    The last one holds the last `TAIL` bytes or the whole file; its last line may have no end.
    """
    rest = b""
    with TextStream(path) as stream:
        while chunk := stream.read(BLOCK):
            rest += chunk
            del chunk  # saves memory
            most = max(len(rest) - TAIL, 0)
            end = max(rest.rfind(b"\n", 0, most), rest.rfind(b"\r", 0, most)) + 1
            if end:
                yield rest[:end], False
                rest = rest[end:]
    yield rest, True
