"""Open a recorded file in any of the known formats; each format has a reader of its own.

`open_table` chooses the reader by the file's extension, then by the file's content.
"""

from __future__ import annotations

import os
from pathlib import Path

from owtsweep.errors import InputError, require
from owtsweep.io.reading import require_regular
from owtsweep.motion.recorded.formats.arrays import open_npz, open_parquet
from owtsweep.motion.recorded.formats.fast_binary import open_fast_binary
from owtsweep.motion.recorded.formats.hawc2 import find_companion, open_hawc2
from owtsweep.motion.recorded.formats.hdf5 import open_gtsdf
from owtsweep.motion.recorded.formats.matlab import open_mat
from owtsweep.motion.recorded.formats.nmea import open_nmea
from owtsweep.motion.recorded.formats.table import ChannelTable, require_channels
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
    ".mat": open_mat,
    ".parquet": open_parquet,
    ".pq": open_parquet,
    ".nmea": open_nmea,
}


def open_table(path: str | Path) -> ChannelTable:
    """Open a file: read the names and the units of its channels, but not yet their numbers.

    Raises InputError if the path is no file that may be read, is empty, or is not what it should
        be.
    """
    path = Path(path)
    require_regular(path)
    require(os.access(path, os.R_OK), f"{path}: you may not read this file; change its permissions")
    require(path.stat().st_size > 0, f"{path}: is empty")
    table = _open(path)
    require_channels(path, len(table.names))
    return table.tidied()


def _open(path: Path) -> ChannelTable:
    suffix = path.suffix.lower()
    if suffix == ".gz":
        suffix = Path(path.stem).suffix.lower()
        if suffix in TEXT:
            return open_text(path)
        raise InputError(f"{path}: only text tables may be compressed ({', '.join(TEXT)})")
    if suffix in READERS:
        return READERS[suffix](path)
    if suffix == ".dat" and find_companion(path, ".sel"):
        return open_hawc2(path)
    if suffix in TEXT:
        if suffix == ".out" and _is_binary(path):  # an .outb file that was renamed
            return open_fast_binary(path)
        return open_text(path)
    known = ", ".join((*TEXT, *READERS))
    raise InputError(f"{path}: unknown extension {suffix!r}: use {known}")


def _is_binary(path: Path) -> bool:
    with path.open("rb") as file:
        return b"\0" in file.read(64)
