"""Prepare texts that other people wrote, such as names of files, for use in plots."""

from __future__ import annotations

from pathlib import Path

from owtsweep.errors import printable

#: The number of characters that fit into a title.
LONGEST = 80


def as_plain(text: str) -> str:
    """Return a text without characters that cannot be printed, and with each `$` escaped.

    So matplotlib does not read any part of the text as a formula.
    """
    return printable(text).replace("$", r"\$")


def name_file(path: str) -> str:
    """Return the name of a file for a title; a name longer than `LONGEST` characters is cut."""
    name = Path(path).name
    return as_plain(name if len(name) <= LONGEST else f"{name[:LONGEST]}...")
