"""Puts a page together: one file with its style, its scripts and its data, which asks for nothing.

Whatever a run calls its schemes or columns, nothing of it is executed: the page's policy lets run
the package's own scripts alone, texts are escaped, and scripts write them as text.
"""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Iterable, Sequence
from functools import cache
from hashlib import sha256
from html import escape
from importlib.resources import files
from string import Template

from owtsweep.errors import printable

#: The scripts, in the order in which they are joined.
SCRIPTS = ("model.js", "chart.js", "stretch.js", "table.js", "page.js")
#: A path that begins at a root or a drive, up to its last separator.
_PLACE = re.compile(r"(?<![\w.:/~])(?:[A-Za-z]:[\\/]|/|~/)(?:[^\s/\\'\"<>,;:]+[/\\])+")


@cache
def read_asset(name: str) -> str:
    """Return the text of a file beside this module."""
    return (files(__package__) / name).read_text(encoding="utf-8")


def make_document(title: str, body: str, data: object = None) -> str:
    """Return a page as one HTML document.

    title: a text, which is escaped here.
    body: HTML.
    data: what the scripts show, as plain JSON data; None for a page without scripts.
    """
    style = read_asset("page.css")
    script = "" if data is None else join_scripts()
    policy = (
        f"default-src 'none'; script-src {_hash(script)}; style-src {_hash(style)}; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )
    return Template(read_asset("page.html")).substitute(
        policy=policy,
        title=clean(title),
        style=style,
        body=body,
        data="" if data is None else embed(data),
        script=script,
    )


def make_page(title: str, parts: Sequence[str], data: object = None) -> str:
    """Return a page below its title as one HTML document; `parts` are HTML, the rest as above."""
    heading = f"<header><h1>{clean(title)}</h1></header>"
    return make_document(title, "\n".join([heading, "<main>", *parts, "</main>"]), data)


def join_scripts() -> str:
    """Return the page's script."""
    joined = "\n".join(read_asset(name) for name in SCRIPTS)
    return f'(() => {{\n"use strict";\n{joined}\n}})();\n'


def embed(data: object) -> str:
    """Return data as a JSON element of a page, in which no text can end the element."""
    shown = _make_printable(data)
    text = json.dumps(shown, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    safe = text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
    return f'<script type="application/json" id="data">{safe}</script>'


def _make_printable(data: object) -> object:
    match data:
        case str():
            return printable(data)
        case dict():
            return {printable(str(key)): _make_printable(value) for key, value in data.items()}
        case list() | tuple():
            return [_make_printable(value) for value in data]
    return data


def clean(text: str) -> str:
    """Return a text as HTML: escaped, without control characters, without folders of a machine."""
    return escape(printable(hide_places(text)))


def hide_places(text: str) -> str:
    """Return a text in which the last part alone is left of each absolute path."""
    return _PLACE.sub("…/", text)


def make_table(caption: str, header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table of texts as HTML."""
    lines = ("".join(f"<td>{clean(text)}</td>" for text in row) for row in rows)
    return frame_table(f"<caption>{clean(caption)}</caption>", header, lines)


def frame_table(caption: str, header: Sequence[str], lines: Iterable[str]) -> str:
    """Return a table as HTML; `caption` and the cells of the `lines` are HTML already."""
    head = "".join(f'<th scope="col">{clean(text)}</th>' for text in header)
    body = "\n".join(f"<tr>{line}</tr>" for line in lines)
    return f"<table>{caption}<thead><tr>{head}</tr></thead><tbody>\n{body}\n</tbody></table>"


def make_picture(png: bytes, description: str) -> str:
    """Return a PNG picture as HTML, inside the page."""
    encoded = base64.b64encode(png).decode()
    return f'<p><img src="data:image/png;base64,{encoded}" alt="{clean(description)}"></p>'


def _hash(text: str) -> str:
    if not text:
        return "'none'"
    return f"'sha256-{base64.b64encode(sha256(text.encode()).digest()).decode()}'"
