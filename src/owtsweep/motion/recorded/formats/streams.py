"""Read the bytes of a text file; a compressed file is unpacked.

A file is refused if it unpacks to too many bytes, or if it has too long a line. What follows the
rows of a table is left out: lines of text, and a last line that was cut off.
"""

from __future__ import annotations

import gzip
import io
import math
import zlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from owtsweep.errors import printable
from owtsweep.io.reading import require_regular
from owtsweep.motion.recorded.formats.table import refuse, shorten

#: Most bytes of a line, and the number of bytes that are read at once.
BLOCK = 1 << 22
#: Bytes at the end of a file that are one block: what follows the rows of a table is among them.
TAIL = 1 << 16
#: A compressed file may unpack to `MOST_UNPACKED` bytes, or to `MOST_TIMES` times its size if that
#: is more.
MOST_UNPACKED, MOST_TIMES = 150_000_000, 50
#: Most lines of text below a table. More are not left out, so the file is refused.
MOST_LINES = 20
#: If this many lines before the last one have one length, a shorter last line was cut off.
ALIKE = 20

#: Splits a line into fields; tells whether a field is a number, a missing value or a time.
Split = Callable[[str], Sequence[str]]
IsValue = Callable[[str], bool]


class TextStream(io.RawIOBase):
    """The bytes of a text file, unpacked if the file's name ends in .gz.

    Reading raises `InputError` if the file is damaged, has a line of more than `BLOCK` bytes (for
    which a parser might need any amount of memory), or unpacks to too many bytes.
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
        try:
            chunk = self._source.read(len(buffer))
        except (OSError, EOFError, zlib.error) as error:
            raise refuse(self._path, f"cannot be read ({shorten(error)})") from None
        self._left -= len(chunk)
        if self._left < 0:
            raise refuse(
                self._path,
                f"unpacks to more than {MOST_UNPACKED / 1e6:g} MB and {MOST_TIMES} times its size; "
                "unpack it yourself if you trust it",
            )
        end = max(chunk.rfind(b"\n"), chunk.rfind(b"\r"))
        self._line = self._line + len(chunk) if end < 0 else len(chunk) - end - 1
        if self._line > BLOCK:
            raise refuse(
                self._path, f"has a line of more than {BLOCK >> 20} MB; is this a text table?"
            )
        buffer[: len(chunk)] = chunk
        return len(chunk)

    def close(self) -> None:
        """Close the file and the stream."""
        self._source.close()
        super().close()


def read_blocks(path: Path) -> Iterator[tuple[bytes, bool]]:
    """Yield a text file, unpacked if it is compressed, in blocks: (block, whether it is the last).

    A block has about `BLOCK` bytes and holds whole lines. The last block holds the last `TAIL`
    bytes of the file, or the whole file if it is shorter; its last line may have no end.
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


def read_rows(
    path: Path, count: int, split: Split, is_value: IsValue, notes: list[str]
) -> Iterator[bytes]:
    """Yield a text file in blocks of whole lines, without what follows the table at its end.

    `count` is its number of columns; `split` and `is_value` tell the fields of a line, and whether
    a field is a number, a missing value or a time. `notes` gets a sentence for each loss.
    """
    for block, is_last in read_blocks(path):
        yield _without_ending(block, count, split, is_value, notes) if is_last else block


def _without_ending(
    block: bytes, count: int, split: Split, is_value: IsValue, notes: list[str]
) -> bytes:
    lines = block.splitlines(keepends=True)
    texts = [line.decode("utf-8", "replace").rstrip("\r\n") for line in lines]
    if lines and not lines[-1].endswith((b"\n", b"\r")) and _is_cut(texts, count, split, is_value):
        notes.append(f"the last line was cut off and is left out: {_quote(texts[-1])}")
        del lines[-1], texts[-1]
    place = len(texts)
    while place and not _is_row(texts[place - 1], count, split, is_value):
        place -= 1
    below = [text for text in texts[place:] if text.strip()]
    if 0 < len(below) <= MOST_LINES:
        notes.append(
            f"{len(below)} line(s) below the table are left out, the first is {_quote(below[0])}"
        )
        del lines[place:]
    return b"".join(lines)


def _is_row(text: str, count: int, split: Split, is_value: IsValue) -> bool:
    """Return whether a line has a value in as many fields as columns, or only values."""
    fields = split(text) if text.strip() else []
    values = [is_value(field) for field in fields]
    return any(values) if len(fields) == count else bool(values) and all(values)


def _is_cut(texts: Sequence[str], count: int, split: Split, is_value: IsValue) -> bool:
    """Return whether the last text is the beginning of a row: too few fields, or a cut number."""
    fields = split(texts[-1])
    if not fields or len(fields) > count or not is_value(fields[0]):
        return False
    before = {len(text) for text in texts[-1 - ALIKE : -1]}
    shorter = len(texts) > ALIKE and len(before) == 1 and len(texts[-1]) < min(before)
    return len(fields) < count or not is_value(fields[-1]) or shorter


def _quote(text: str) -> str:
    return f"'{printable(text.strip()[:40])}'"
