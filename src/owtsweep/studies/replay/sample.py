"""The sample records of the package: 60 s each, made by experiments/make_sample.py."""

from __future__ import annotations

import gzip
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

from owtsweep.config import require
from owtsweep.errors import InputError
from owtsweep.io.files import name_refusal, write_all

#: A hub's motion; and the recordings of an IMU and a GNSS on a hub, with the true position.
MOTION, SENSORS = "sample_motion.csv", "sample_sensors.csv"
#: A table for `replay.table`; the pattern "sample_*.csv" does not match its name.
TABLE = "table_of_samples.csv"
ROWS = f"file,natural period (s),rms (m)\n{MOTION},4,0.3\n{SENSORS},3.5,0.2\n"


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
