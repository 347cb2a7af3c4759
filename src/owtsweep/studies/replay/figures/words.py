"""Prepare texts that other people wrote, such as names of files, for use in plots."""

from __future__ import annotations

from pathlib import Path

from owtsweep.errors import printable

#: The number of characters that fit into a title.
LONGEST = 80


def as_plain(text: str) -> str:
    """Return a text in a form that matplotlib draws as it is, without reading a part as a formula.

    Characters that cannot be printed are replaced by escape sequences, and each `$` is escaped.
    """
    return printable(text).replace("$", r"\$")


def name_file(path: str) -> str:
    """Return the name of the file at `path` for a title, cut to `LONGEST` characters."""
    name = Path(path).name
    return as_plain(name if len(name) <= LONGEST else f"{name[:LONGEST]}...")
