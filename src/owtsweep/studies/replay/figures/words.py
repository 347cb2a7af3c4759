"""Texts of other people in figures."""

from __future__ import annotations

from pathlib import Path

from owtsweep.errors import printable

#: Characters that fit into a title.
LONGEST = 80


def as_plain(text: str) -> str:
    """A text in which matplotlib sees no formula, and which can be printed."""
    return printable(text).replace("$", r"\$")


def name_file(path: str) -> str:
    """The name of a file, for a title; a long one is cut."""
    name = Path(path).name
    return as_plain(name if len(name) <= LONGEST else f"{name[:LONGEST]}...")
