"""One reader per file format; `open_table` chooses by the extension, then by the content."""

from __future__ import annotations

from pathlib import Path

from owtsweep.motion.recorded.formats.arrays import open_npz, open_parquet
from owtsweep.motion.recorded.formats.fast_binary import open_fast_binary
from owtsweep.motion.recorded.formats.gtsdf import open_gtsdf
from owtsweep.motion.recorded.formats.hawc2 import find_companion, open_hawc2
from owtsweep.motion.recorded.formats.table import ChannelTable, refuse
from owtsweep.motion.recorded.formats.text import open_text

#: Extensions of text tables. Only these may be compressed (.gz).
TEXT = (".csv", ".tsv", ".txt", ".asc", ".out", ".dat")

READERS = {
    ".outb": open_fast_binary,
    ".sel": open_hawc2,
    ".hdf5": open_gtsdf,
    ".h5": open_gtsdf,
    ".hdf": open_gtsdf,
    ".npz": open_npz,
    ".parquet": open_parquet,
    ".pq": open_parquet,
}


def open_table(path: str | Path) -> ChannelTable:
    """Open a file of channels.

    Raises
    ------
    InputError
        If the file does not exist, is empty, or is not what its extension says.
    """
    path = Path(path)
    if not path.exists():
        raise refuse(path, "no such file")
    if path.is_dir():
        raise refuse(path, "is a folder, not a file")
    if path.stat().st_size == 0:
        raise refuse(path, "is empty")
    suffix = path.suffix.lower()
    if suffix == ".gz":
        suffix = Path(path.stem).suffix.lower()
        if suffix in TEXT:
            return open_text(path)
        raise refuse(path, f"only text tables may be compressed ({', '.join(TEXT)})")
    if suffix in READERS:
        return READERS[suffix](path)
    if suffix == ".dat" and find_companion(path, ".sel"):
        return open_hawc2(path)
    if suffix in TEXT:
        if suffix == ".out" and _is_binary(path):  # an .outb file that was renamed
            return open_fast_binary(path)
        return open_text(path)
    raise refuse(path, f"unknown extension {suffix!r}: use {', '.join((*TEXT, *READERS))}")


def _is_binary(path: Path) -> bool:
    with path.open("rb") as file:
        return b"\0" in file.read(64)
