"""The estimates as files: estimates.parquet, and one CSV per scheme."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.studies.replay.session import Session
from owtsweep.sweep.files import write_atomically

if TYPE_CHECKING:
    import pandas as pd

STATES = ("x", "y", "vx", "vy")
COLUMNS = ("time", "scheme", *STATES, *(f"{name}_std" for name in STATES))


def frame(session: Session) -> pd.DataFrame:
    """All schemes' estimates, one below the other; columns `COLUMNS`.

    time in s on the file's clock; x, y in m with the origin put back, so that they lie over the
    positions in the file; velocities in m/s; the standard deviations of all four (NaN for a scheme
    without covariance).
    """
    import pandas as pd

    tables = [pd.DataFrame(columns) for _, columns in _columns(session)]
    if not tables:
        return pd.DataFrame(columns=list(COLUMNS))
    return pd.concat(tables, ignore_index=True)


def write(session: Session, folder: Path) -> list[Path]:
    """Write estimates.parquet and estimates/<scheme>.csv into a folder; returns the files."""
    import pyarrow as pa
    import pyarrow.csv as pc
    import pyarrow.parquet as pq

    single = folder / "estimates"
    single.mkdir(parents=True, exist_ok=True)
    tables, files = [], []
    for name, columns in _columns(session):
        table = pa.table(columns)
        tables.append(table)
        buffer = io.BytesIO()
        pc.write_csv(table.drop_columns(["scheme"]), buffer)
        files.append(single / f"{name}.csv")
        write_atomically(files[-1], buffer.getvalue())
    if tables:
        buffer = io.BytesIO()
        pq.write_table(pa.concat_tables(tables), buffer, write_page_checksum=True)
        files.insert(0, folder / "estimates.parquet")
        write_atomically(files[0], buffer.getvalue())
    return files


def _columns(session: Session) -> Iterator[tuple[str, dict[str, Any]]]:
    record = session.record
    origin = np.concatenate([record.origin, np.zeros(2)])
    for name, estimated in session.estimated.items():
        state, deviation = estimated.state + origin, estimated.deviation
        yield (
            name,
            {
                "time": record.time,
                "scheme": np.full(record.steps, name, dtype=object),
                **{column: state[:, i] for i, column in enumerate(STATES)},
                **{f"{column}_std": deviation[:, i] for i, column in enumerate(STATES)},
            },
        )
