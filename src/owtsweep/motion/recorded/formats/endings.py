"""What may follow the rows of a text table: lines of text, and a last line that was cut off."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from owtsweep.errors import printable
from owtsweep.motion.recorded.formats.streams import read_blocks

#: Most lines of text below a table. More are not left out, so the file is refused.
MOST_LINES = 20
#: If this many lines before the last one have one length, a shorter last line was cut off.
ALIKE = 20

#: Splits a line into fields; tells whether a field is a number, a missing value or a time.
Split = Callable[[str], Sequence[str]]
IsValue = Callable[[str], bool]


def read_rows(
    path: Path, count: int, split: Split, is_value: IsValue, notes: list[str]
) -> Iterator[bytes]:
    """Yield a text file in blocks of whole lines, without what follows the table at its end.

    What follows the table is looked for in the last block alone.

    Parameters
    ----------
    path
        The file.
    count
        Number of columns.
    split, is_value
        Functions: the fields of a line; whether a field is a number, a missing value or a time.
    notes
        For each loss a sentence for the user is added to this list.
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
    """Return False for a blank line and for text, but True for numbers, even if some are missing.

    A line with as many fields as columns is a row if any of them is a value.
    """
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
