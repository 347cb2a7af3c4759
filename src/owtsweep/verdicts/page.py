"""Write a document as Markdown, which links to its pictures, or as HTML, which embeds them."""

from __future__ import annotations

import base64
import html
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from owtsweep.io import markdown

#: The style of the HTML page: plain and printable, without external fonts or files.
CSS = """
body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 62rem; margin: 2rem auto;
  padding: 0 1rem; }
h1, h2, h3 { line-height: 1.2; margin: 2rem 0 .6rem; }
h2 { border-bottom: 1px solid #ccc; padding-bottom: .2rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .85rem; margin: .8rem 0; }
th, td { border-bottom: 1px solid #ddd; padding: .25rem .6rem; text-align: left;
  vertical-align: top; }
th { border-bottom: 2px solid #888; }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
td.good { background: #e3f2e6; } td.bad { background: #fbe5dd; } td.open { background: #f3f1e1; }
figure { margin: 1rem 0; } img { max-width: 100%; height: auto; }
figcaption { font-size: .85rem; color: #555; }
"""
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
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{html.escape(title)}</title>\n<style>{CSS}</style>\n</head>\n"
        f"<body>\n{body}\n</body>\n</html>\n"
    )


def _html(block: Block) -> str:
    match block:
        case Heading(text, level):
            return f"<h{level}>{html.escape(text)}</h{level}>"
        case Paragraph(text):
            return f"<p>{html.escape(text)}</p>"
        case Bullets(items):
            return "<ul>\n" + "\n".join(f"<li>{html.escape(item)}</li>" for item in items) + "</ul>"
        case Picture(path, caption):
            data = base64.b64encode(path.read_bytes()).decode()
            text = html.escape(caption)
            return (
                f'<figure><img alt="{text}" src="data:image/png;base64,{data}">'
                f"<figcaption>{text}</figcaption></figure>"
            )
        case TextTable(columns, rows, numbers):
            are_numbers = [column in numbers for column in columns]
            head = _line("th", columns, are_numbers)
            body = "\n".join(_line("td", row, are_numbers) for row in rows)
            return (
                f'<div class="scroll"><table>\n<thead>{head}</thead>\n'
                f"<tbody>\n{body}\n</tbody></table></div>"
            )


def _line(tag: str, cells: Sequence[str], are_numbers: Sequence[bool]) -> str:
    line = ""
    for text, is_number in zip(cells, are_numbers, strict=True):
        classes = " ".join(filter(None, ["number" if is_number else "", CLASSES.get(text, "")]))
        attribute = f' class="{classes}"' if classes else ""
        line += f"<{tag}{attribute}>{html.escape(text)}</{tag}>"
    return f"<tr>{line}</tr>"
