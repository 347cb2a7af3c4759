"""The estimates as files: estimates.parquet, and one CSV per scheme.

Both are written piece by piece, one scheme at a time: of a day at 100 Hz all schemes would take
several GB.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.schemes import resolve_all
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.estimating import Estimated
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.measuring import listen, pieces_of
from owtsweep.studies.replay.memory import LONG, give_back
from owtsweep.studies.replay.record import Record
from owtsweep.studies.replay.session import SchemeFailed, each

STATES = ("x", "y", "vx", "vy")
COLUMNS = ("time", "scheme", *STATES, *(f"{name}_std" for name in STATES))
#: Rows of a piece.
PIECE = 500_000
#: Bytes of a row in CSV and in Parquet, roughly.
ROW = (160, 60)


def write(
    config: ReplayConfig, file: str, folder: Path, say: Callable[[str], None] = lambda text: None
) -> list[Path]:
    """Write estimates.parquet and estimates/<scheme>.csv of a record; returns the files.

    Columns `COLUMNS`, replicate 0: time in s on the file's clock; x, y in m with the origin put
    back, so that they lie over the positions in the file; velocities in m/s; the standard
    deviations of all four (NaN for a scheme without covariance).

    Parameters
    ----------
    say
        Is told in words what takes its time, where the record is long.
    """
    record = load_record(config, file)
    sensors = sensing.sensors(config.sensors)
    signals = listen(config, sensors, record, 0)
    schemes = {scheme.name: scheme for scheme in resolve_all(config.schemes, config)}
    (folder / "estimates").mkdir(parents=True, exist_ok=True)
    if record.steps > LONG:
        rows = record.steps * len(schemes)
        say(
            f"writing {rows:,} rows of estimates, some {rows * ROW[0] / 1e9:.1f} GB of CSV and "
            f"{rows * ROW[1] / 1e9:.1f} GB of Parquet"
        )
    while True:
        pieces = {
            name: each(config, scheme, sensors, signals, pieces_of(record.steps, PIECE))
            for name, scheme in schemes.items()
        }
        try:
            files = _written(record, pieces, folder)
            give_back(record)
            return files
        except SchemeFailed as error:  # what it had given is not left among the others'
            del schemes[error.name]


def _written(
    record: Record, schemes: Mapping[str, Iterator[Estimated]], folder: Path
) -> list[Path]:
    import pyarrow as pa
    import pyarrow.csv as pc
    import pyarrow.parquet as pq

    files = [folder / "estimates.parquet"]
    fields = [(name, pa.string() if name == "scheme" else pa.float64()) for name in COLUMNS]
    schema = pa.schema(fields)
    own = schema.remove(schema.get_field_index("scheme"))
    with ExitStack() as stack:
        target = stack.enter_context(_whole(files[0]))
        writer = stack.enter_context(pq.ParquetWriter(target, schema, write_page_checksum=True))
        for name, pieces in schemes.items():
            files.append(folder / "estimates" / f"{name}.csv")
            with _whole(files[-1]) as temporary, pc.CSVWriter(temporary, own) as text:
                for columns in _columns(record, pieces, name):
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


def _columns(record: Record, pieces: Iterator[Estimated], name: str) -> Iterator[dict[str, Any]]:
    origin = np.concatenate([record.origin, np.zeros(2)])
    first = 0
    for estimated in pieces:
        part = slice(first, first + len(estimated.state))
        first = part.stop
        state, deviation = estimated.state + origin, estimated.deviation
        yield {
            "time": record.time_at(part),
            "scheme": [name] * len(state),
            **{column: state[:, i] for i, column in enumerate(STATES)},
            **{f"{column}_std": deviation[:, i] for i, column in enumerate(STATES)},
        }
