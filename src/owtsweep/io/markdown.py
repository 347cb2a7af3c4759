"""Tables in Markdown."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence


def table(
    columns: Sequence[str], rows: Iterable[Sequence[str]], *, numbers: Collection[str] = ()
) -> str:
    """A table in Markdown, without a line break after its last row.

    Parameters
    ----------
    columns
        Headings.
    rows
        Text, one cell per column.
    numbers
        Columns that are aligned to the right.
    """
    rule = ["---:" if column in numbers else "---" for column in columns]
    return "\n".join(_line(cells) for cells in (columns, rule, *rows))


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
