"""Which reader a file needs: by its extension, then by its content."""

from __future__ import annotations

from pathlib import Path

from owtsweep.motion.recorded.formats.arrays import open_npz, open_parquet
from owtsweep.motion.recorded.formats.fast_binary import open_fast_binary
from owtsweep.motion.recorded.formats.gtsdf import open_gtsdf
from owtsweep.motion.recorded.formats.hawc2 import companion, open_hawc2
from owtsweep.motion.recorded.formats.table import Table, refuse
from owtsweep.motion.recorded.formats.text import open_text

#: Extensions of tables of text; these alone may also be compressed (.gz).
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


def open_table(path: str | Path) -> Table:
    """Open a file of channels.

    Raises
    ------
    InputError
        If there is no such file, it is empty, or it is not what its extension says.
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
    if suffix == ".dat" and companion(path, ".sel"):
        return open_hawc2(path)
    if suffix in TEXT:
        if suffix == ".out" and _is_binary(path):  # renamed: the kind tells
            return open_fast_binary(path)
        return open_text(path)
    raise refuse(path, f"unknown extension {suffix!r}: use {', '.join((*TEXT, *READERS))}")


def _is_binary(path: Path) -> bool:
    with path.open("rb") as file:
        return b"\0" in file.read(64)
