"""Write a document as Markdown, which links to its pictures, or as HTML, which embeds them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from owtsweep.io import markdown
from owtsweep.report.document import clean, frame_table, make_document, make_picture

#: Text of a table's cell -> CSS class that sets the cell's colour.
CLASSES = {
    "yes": "good", "reproduced": "good", "consistent": "good", "no": "bad", "not reproduced": "bad",
    "undecided": "open", "missing": "open",
}  # fmt: skip


class Heading(NamedTuple):
    """A heading; `level` is 1 (largest) to 3."""

    text: str
    level: int = 2


class Paragraph(NamedTuple):
    """A paragraph of running text."""

    text: str


class Bullets(NamedTuple):
    """A list of bullet points."""

    items: Sequence[str]


class TextTable(NamedTuple):
    """A table of texts; `numbers` names the columns that are aligned to the right."""

    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    numbers: Sequence[str] = ()


class Picture(NamedTuple):
    """A PNG file and a caption that tells what the file shows."""

    path: Path
    caption: str


Block = Heading | Paragraph | Bullets | TextTable | Picture


def to_markdown(blocks: Sequence[Block], folder: Path) -> str:
    """Return a document as Markdown; links are relative to `folder`, in which the pictures lie."""
    return "\n\n".join(_markdown(block, folder) for block in blocks) + "\n"


def _markdown(block: Block, folder: Path) -> str:
    match block:
        case Heading(text, level):
            return f"{'#' * level} {markdown.escape(text)}"
        case Paragraph(text):
            return markdown.escape(text)
        case Bullets(items):
            return "\n".join(f"- {markdown.escape(item)}" for item in items)
        case Picture(path, caption):
            return f"![{markdown.escape(caption)}]({path.relative_to(folder).as_posix()})"
        case TextTable(columns, rows, numbers):
            return markdown.table(columns, rows, numbers=numbers)


def to_html(blocks: Sequence[Block], title: str) -> str:
    """Return a document as the text of one HTML file, in which all pictures are embedded."""
    body = "\n".join(_html(block) for block in blocks)
    return make_document(title, f"<main>\n{body}\n</main>")


def _html(block: Block) -> str:
    match block:
        case Heading(text, level):
            return f"<h{level}>{clean(text)}</h{level}>"
        case Paragraph(text):
            return f"<p>{clean(text)}</p>"
        case Bullets(items):
            return "<ul>\n" + "\n".join(f"<li>{clean(item)}</li>" for item in items) + "</ul>"
        case Picture(path, caption):
            picture = make_picture(path.read_bytes(), caption)
            return f"<figure>{picture}<figcaption>{clean(caption)}</figcaption></figure>"
        case TextTable(columns, rows, numbers):
            kinds = ["number" if column in numbers else "" for column in columns]
            lines = ("".join(map(_cell, row, kinds)) for row in rows)
            return f'<div class="wide words">{frame_table("", columns, lines)}</div>'


def _cell(text: str, kind: str) -> str:
    classes = f"{kind} {CLASSES.get(text, '')}".strip()
    attribute = f' class="{classes}"' if classes else ""
    return f"<td{attribute}>{clean(text)}</td>"
