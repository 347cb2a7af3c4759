"""Open a recorded file in any of the known formats; each format has a reader of its own.

`open_table` chooses the reader by the file's extension, then by the file's content.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from owtsweep.errors import require
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
    **dict.fromkeys(TEXT, open_text),
    ".outb": open_fast_binary,
    ".sel": open_hawc2,
    **dict.fromkeys((".hdf5", ".h5", ".hdf"), open_gtsdf),
    ".npz": open_npz,
    ".mat": open_mat,
    **dict.fromkeys((".parquet", ".pq"), open_parquet),
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
    table = _find_reader(path)(path)
    require_channels(path, len(table.names))
    return table.tidied()


def _find_reader(path: Path) -> Callable[[Path], ChannelTable]:
    suffix = path.suffix.lower()
    if suffix == ".gz":
        listed = ", ".join(TEXT)
        is_text = Path(path.stem).suffix.lower() in TEXT
        require(is_text, f"{path}: only text tables may be compressed ({listed})")
        return open_text
    require(suffix in READERS, f"{path}: unknown extension {suffix!r}: use {', '.join(READERS)}")
    if suffix == ".dat" and find_companion(path, ".sel"):
        return open_hawc2
    if suffix == ".out":
        with path.open("rb") as file:
            if b"\0" in file.read(64):  # an .outb file that was renamed
                return open_fast_binary
    return READERS[suffix]
