"""Read NumPy archives (.npz, without pickled objects) and Parquet files."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.recorded.formats.table import ChannelTable, number_repeats, refuse, shorten

AXES = "xyz"


def open_npz(path: Path) -> ChannelTable:
    """Open a NumPy archive of arrays of equal length n.

    An array of shape (n,) is one channel. An array of shape (n, 2) becomes the channels name_x and
    name_y.

    Raises
    ------
    InputError
        For a damaged archive, pickled objects, or arrays of different lengths.
    """
    arrays: dict[str, Array] = {}
    if not zipfile.is_zipfile(path):  # np.load would treat any other file as a pickle
        raise refuse(path, "is not a whole .npz archive")
    try:
        with np.load(path, allow_pickle=False) as archive:
            for key in archive.files:
                array = archive[key]
                if array.dtype.kind not in "fiub" or array.ndim not in (1, 2):
                    continue
                if array.ndim == 1:
                    arrays[key] = array
                    continue
                for column in range(array.shape[1]):
                    axis = AXES[column] if array.shape[1] <= len(AXES) else str(column + 1)
                    arrays[f"{key}_{axis}"] = array[:, column]
    except ValueError as error:
        if "allow_pickle" in str(error):
            reason = "holds pickled objects, which can run code: save plain arrays instead"
        else:
            reason = f"cannot be read ({shorten(error)})"
        raise refuse(path, reason) from None
    except (OSError, EOFError, zipfile.BadZipFile, AttributeError) as error:
        raise refuse(path, f"is not a whole .npz archive ({error})") from None
    lengths = sorted({len(array) for array in arrays.values()})
    if len(lengths) != 1:
        said = f"arrays of different lengths ({', '.join(map(str, lengths[:5]))})"
        raise refuse(path, f"has {said if lengths else 'no array of numbers'}")

    def load(names: Sequence[str], rows: int | None) -> Mapping[str, Array]:
        return {name: np.array(arrays[name][:rows], dtype=float) for name in names}

    return ChannelTable(path, "NumPy archive", tuple(arrays), ("",) * len(arrays), load)


def open_parquet(path: Path) -> ChannelTable:
    """Open a Parquet file.

    Units come from the fields' metadata (`unit` or `units`). Timestamps become seconds from the
    first one.

    Raises
    ------
    InputError
        If the file is damaged; on loading, also if a column does not hold numbers.
    """
    import pyarrow as pa
    from pyarrow import parquet

    try:
        schema = parquet.read_schema(path)
    except (pa.ArrowInvalid, OSError) as error:
        raise refuse(path, f"is not a whole Parquet file ({shorten(error)})") from None
    units = []
    for field in schema:
        metadata = field.metadata or {}
        stated = metadata.get(b"unit", metadata.get(b"units", b"")).decode()
        units.append("s" if pa.types.is_timestamp(field.type) else stated)

    def load(names: Sequence[str], rows: int | None) -> Mapping[str, Array]:
        try:
            table = parquet.read_table(
                path, columns=list(names), page_checksum_verification=True
            ).slice(0, rows)
        except (pa.ArrowInvalid, OSError) as error:
            raise refuse(path, f"is damaged ({shorten(error)})") from None
        result: dict[str, Array] = {}
        for name in names:
            column = table.column(name)
            if pa.types.is_timestamp(column.type):
                ticks = column.cast(pa.timestamp("ns")).cast(pa.int64()).to_numpy()
                result[name] = (ticks - ticks[0]) * 1e-9
                continue
            try:
                result[name] = np.array(column.cast(pa.float64()).to_numpy(), dtype=float)
            except (pa.ArrowInvalid, pa.ArrowNotImplementedError):
                raise refuse(path, f"column {name} holds no numbers ({column.type})") from None
        return result

    return ChannelTable(path, "Parquet", number_repeats(schema.names), tuple(units), load)
