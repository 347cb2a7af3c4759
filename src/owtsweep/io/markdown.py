"""Makes tables in Markdown."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence


def table(
    columns: Sequence[str], rows: Iterable[Sequence[str]], *, numbers: Collection[str] = ()
) -> str:
    """Return a table in Markdown as one text, without a line break after the last row.

    `rows` have one text per column; `numbers` are the headings of columns to align to the right.
    """
    rule = ["---:" if column in numbers else "---" for column in columns]
    return "\n".join(_line(cells) for cells in (columns, rule, *rows))


def escape(text: str) -> str:
    """Return a text as one line of Markdown that makes no HTML tag, no link and no picture."""
    line = re.sub(r"[\r\n\v\f\x1c-\x1e\x85\u2028\u2029]+", " ", text)
    return re.sub(r"<(?=[A-Za-z/!?])", "&lt;", line).replace("](", "]\\(")


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(escape(cell).replace("|", "\\|") for cell in cells) + " |"
