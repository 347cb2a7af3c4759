"""Write the estimates of all schemes to files: one Parquet file, and one CSV file per scheme.

The files are written piece by piece, one scheme at a time: a whole day at 100 Hz would take several
GB of memory.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.studies.hub.public import make_sensors, resolve_all
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.record import (
    LONG,
    ReplayRecord,
    cut_into_pieces,
    listen,
    release_memory,
)
from owtsweep.studies.replay.session import SchemeFailed, run_scheme

STATES = ("x", "y", "vx", "vy")
COLUMNS = ("time", "scheme", *STATES, *(f"{name}_std" for name in STATES))
#: Rows written at once.
PIECE = 500_000
#: Approximate bytes of a row in CSV and in Parquet.
ROW = (160, 60)


def write(config: ReplayConfig, file: str, folder: Path, say: Callable[[str], None]) -> None:
    """Write all schemes' estimates on a record (replicate 0) to Parquet, and to a CSV per scheme.

    The columns are `COLUMNS`: time in s and x, y in m as in the record's file, m/s, and standard
    deviations, NaN without a covariance; the CSV have no `scheme`. A scheme that fails is left out.

    folder: is made if need be.
    say: shows the user a line, before slow work on a long record.
    """
    record = load_record(config, file)
    sensors = make_sensors(config.sensors)
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
            name: run_scheme(config, scheme, sensors, signals, cut_into_pieces(record.steps, PIECE))
            for name, scheme in schemes.items()
        }
        try:
            _write_all(record, pieces, folder)
            break
        except SchemeFailed as error:  # start again, so that the files hold no part of this scheme
            del schemes[error.name]
    release_memory(record)


def _write_all(
    record: ReplayRecord, schemes: Mapping[str, Iterator[Trajectory]], folder: Path
) -> None:
    import pyarrow as pa
    import pyarrow.csv as pc
    import pyarrow.parquet as pq

    fields = [(name, pa.string() if name == "scheme" else pa.float64()) for name in COLUMNS]
    schema = pa.schema(fields)
    schema_of_csv = schema.remove(schema.get_field_index("scheme"))
    with (
        _replace_when_written(folder / "estimates.parquet") as target,
        pq.ParquetWriter(target, schema, write_page_checksum=True) as writer,
    ):
        for name, pieces in schemes.items():
            with (
                _replace_when_written(folder / "estimates" / f"{name}.csv") as temporary,
                pc.CSVWriter(temporary, schema_of_csv) as text,
            ):
                for columns in _make_columns(record, pieces, name):
                    table = pa.table(columns, schema=schema)
                    writer.write_table(table)
                    text.write_table(table.drop_columns(["scheme"]))


@contextmanager
def _replace_when_written(path: Path) -> Iterator[str]:
    """Give the name of a temporary file inside a `with` block; then rename this file to `path`."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        yield str(temporary)
        os.replace(temporary, path)
    except OSError as error:
        error.add_note(str(path))  # the error itself has the temporary name, or none
        raise
    finally:
        temporary.unlink(missing_ok=True)


def _make_columns(
    record: ReplayRecord, pieces: Iterator[Trajectory], name: str
) -> Iterator[dict[str, object]]:
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
