"""Gives files of records labels, hashes and names for titles; writes the sample records."""

from __future__ import annotations

import gzip
import os
from collections.abc import Sequence
from functools import lru_cache
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

from owtsweep.config import require
from owtsweep.errors import InputError, printable
from owtsweep.io import reading
from owtsweep.io.files import name_refusal, write_all
from owtsweep.io.reading import refuse_unreadable, require_regular

#: The number of characters that fit into a title.
LONGEST = 80
#: A hub's motion; and the recordings of an IMU and a GNSS on a hub, with the true position.
MOTION, SENSORS = "sample_motion.csv", "sample_sensors.csv"
#: A table for `replay.table`; the pattern "sample_*.csv" does not match its name.
TABLE = "table_of_samples.csv"
ROWS = f"file,natural period (s),rms (m)\n{MOTION},4,0.3\n{SENSORS},3.5,0.2\n"


def label_files(files: Sequence[str]) -> dict[str, str]:
    """Return label -> file, in order: the file's name without extensions, or numbered."""
    labels: dict[str, str] = {}
    for file in files:
        stem = printable(Path(file).name.split(".")[0] or Path(file).name)
        label, number = stem, 2
        while label in labels:
            label, number = f"{stem}-{number}", number + 1
        labels[label] = file
    return labels


def hash_file(file: str) -> str:
    """Return the hash of a file's contents; NAME.sel and NAME.dat of HAWC2 share one hash."""
    path = Path(file)
    parts = [path]
    if path.suffix.lower() in (".sel", ".dat"):
        parts = [p for p in (path.with_suffix(".sel"), path.with_suffix(".dat")) if p.exists()]
    for part in parts:
        require_regular(part)
    with refuse_unreadable(path):
        states = [(part, part.stat().st_size, part.stat().st_mtime_ns) for part in parts]
        return "".join(_hash(*state) for state in states)


@lru_cache(maxsize=4096)
def _hash(path: Path, size: int, modified: int) -> str:
    return reading.hash_file(path)  # once per state of the file


def may_read(file: str) -> bool:
    """Return False if a file is there but its permissions do not let this process read it."""
    return os.access(file, os.R_OK) or not os.path.exists(file)


def name_file(path: str) -> str:
    """Return the name of the file at `path` for a title, cut to `LONGEST` characters."""
    name = Path(path).name
    return printable(name if len(name) <= LONGEST else f"{name[:LONGEST]}...")


def find_data() -> Traversable:
    """Return the package's folder of sample records."""
    return resources.files("owtsweep.studies.replay") / "data"


def write_sample(folder: Path) -> list[Path]:
    """Write the sample records, and a table that names them, into a folder; return their paths.

    Raises InputError if a file of one of these names has other content or cannot be written;
        nothing is written then.
    """
    contents = {folder / TABLE: ROWS.encode()}
    for name in (MOTION, SENSORS):
        contents[folder / name] = gzip.decompress((find_data() / f"{name}.gz").read_bytes())
    try:
        for path, content in contents.items():
            require(
                not path.exists() or (path.is_file() and path.read_bytes() == content),
                f"--sample: {path.name} is there already, with other content; rename it, or "
                "write the sample in another folder",
            )
        write_all(contents)
    except OSError as error:
        raise InputError(f"--sample: {name_refusal(error, folder)}") from error
    return list(contents)
