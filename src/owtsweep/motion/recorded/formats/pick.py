"""Which reader a file needs."""

from __future__ import annotations

from pathlib import Path

from owtsweep.motion.recorded.formats.table import Table, refuse
from owtsweep.motion.recorded.formats.text import open_text

#: Extensions of tables of text.
TEXT = (".csv", ".tsv", ".txt", ".out", ".dat", ".asc")


def open_table(path: str | Path) -> Table:
    """Open a file of channels.

    Raises
    ------
    InputError
        If there is no such file, it is empty, or it is not what its extension says.
    """
    path = Path(path)
    if path.is_dir() or not path.exists():
        raise refuse(path, "no such file" if not path.exists() else "is a folder, not a file")
    if path.stat().st_size == 0:
        raise refuse(path, "is empty")
    suffix = Path(path.stem).suffix.lower() if path.suffix.lower() == ".gz" else path.suffix.lower()
    if suffix in TEXT:
        return open_text(path)
    raise refuse(path, f"unknown extension {suffix!r}: use one of {', '.join(TEXT)}")
