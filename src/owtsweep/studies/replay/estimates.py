"""The estimates as files: estimates.parquet, and one CSV per scheme.

Both are written piece by piece, one scheme at a time: of a day at 100 Hz all schemes would take
several GB.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.estimating import Estimated
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.measuring import measure
from owtsweep.studies.replay.record import Record
from owtsweep.studies.replay.session import each

STATES = ("x", "y", "vx", "vy")
COLUMNS = ("time", "scheme", *STATES, *(f"{name}_std" for name in STATES))
#: Rows of a piece.
PIECE = 500_000


def write(config: ReplayConfig, file: str, folder: Path) -> list[Path]:
    """Write estimates.parquet and estimates/<scheme>.csv of a record; returns the files.

    Columns `COLUMNS`, replicate 0: time in s on the file's clock; x, y in m with the origin put
    back, so that they lie over the positions in the file; velocities in m/s; the standard
    deviations of all four (NaN for a scheme without covariance).
    """
    import pyarrow as pa
    import pyarrow.csv as pc
    import pyarrow.parquet as pq

    record = load_record(config, file)
    sensors = sensing.sensors(config.sensors)
    measured = measure(config, sensors, record, 0)
    single = folder / "estimates"
    single.mkdir(parents=True, exist_ok=True)
    files = [folder / "estimates.parquet"]
    fields = [(name, pa.string() if name == "scheme" else pa.float64()) for name in COLUMNS]
    schema = pa.schema(fields)
    with ExitStack() as stack:
        target = stack.enter_context(_whole(files[0]))
        writer = stack.enter_context(pq.ParquetWriter(target, schema, write_page_checksum=True))
        for name, estimated in each(config, sensors, measured):
            if isinstance(estimated, str):
                continue
            files.append(single / f"{name}.csv")
            own = schema.remove(schema.get_field_index("scheme"))
            with _whole(files[-1]) as temporary, pc.CSVWriter(temporary, own) as text:
                for columns in _pieces(record, estimated, name):
                    table = pa.table(columns, schema=schema)
                    writer.write_table(table)
                    text.write_table(table.drop_columns(["scheme"]))
    return files


@contextmanager
def _whole(path: Path) -> Iterator[str]:
    """A temporary name beside a file that takes its place once it is written."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        yield str(temporary)
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def _pieces(record: Record, estimated: Estimated, name: str) -> Iterator[dict[str, Any]]:
    origin = np.concatenate([record.origin, np.zeros(2)])
    for first in range(0, record.steps, PIECE):
        part = slice(first, min(first + PIECE, record.steps))
        state = estimated.state[part] + origin
        deviation = estimated.deviation_of(part)
        yield {
            "time": record.begin + record.step * np.arange(part.start, part.stop),
            "scheme": [name] * len(state),
            **{column: state[:, i] for i, column in enumerate(STATES)},
            **{f"{column}_std": deviation[:, i] for i, column in enumerate(STATES)},
        }
