"""Read HDF5 in the General Time Series Data Format (gtsdf), which HAWC2 writes as .hdf5.

The groups block0000, block0001, ... hold `data` (observations, attributes) and the attributes
`time_step` and `time_start`. They may also hold `time` (0, 1, 2, ... if absent), `gains` and
`offsets`. Then time = time_start + time_step * time and value = data * gain + offset. In integer
data the largest value of the type means missing. The root holds `attribute_names` and
`attribute_units`, without time. The documentation of DTU's Wind Energy Toolbox (wetb.gtsdf) defines
the format.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.recorded.formats.table import ChannelTable, number_repeats, refuse, shorten

TIME = "Time"


def open_gtsdf(path: Path) -> ChannelTable:
    """Open a gtsdf file; needs h5py.

    Raises
    ------
    InputError
        If h5py is not installed, or the file is not HDF5 or not gtsdf.
    """
    try:
        import h5py
    except ImportError:
        raise refuse(path, "HDF5 needs h5py: pip install 'owtsweep[recorded]'") from None
    try:
        with h5py.File(path, "r") as file:
            blocks = sorted(name for name in file if name.startswith("block"))
            if not blocks or any("data" not in file[block] for block in blocks):
                raise refuse(path, "is HDF5 but not gtsdf (no block0000/data)")
            count = file[blocks[0]]["data"].shape[1]
            names = _read_words(file, "attribute_names", count)
            units = _read_words(file, "attribute_units", count)
    except OSError as error:
        raise refuse(path, f"is not a whole HDF5 file ({shorten(error)})") from None
    names = list(number_repeats([TIME, *(name or str(k + 1) for k, name in enumerate(names))]))
    units = ["s", *("" if unit == "-" else unit for unit in units)]

    def load(wanted: Sequence[str], rows: int | None) -> Mapping[str, Array]:
        with h5py.File(path, "r") as file:
            return _load(file, blocks, {name: names.index(name) for name in wanted}, rows)

    return ChannelTable(path, "gtsdf (HDF5)", tuple(names), tuple(units), load)


def _read_words(file: Any, key: str, count: int) -> list[str]:
    """Read the names or the units of `count` channels; each is "" if the file states none."""
    raw = file[key][:] if key in file else []
    words = [text.decode("utf-8") if isinstance(text, bytes) else str(text) for text in raw]
    return [word.strip() for word in words] if len(words) == count else [""] * count


def _load(
    file: Any, blocks: list[str], places: Mapping[str, int], rows: int | None
) -> dict[str, Array]:
    parts: dict[str, list[Array]] = {name: [] for name in places}
    read = 0
    for block in blocks:
        group = file[block]
        data = group["data"]
        steps = data.shape[0] if rows is None else min(data.shape[0], rows - read)
        if steps <= 0:
            break
        for name, place in places.items():
            if place == 0:
                count = group["time"][:steps] if "time" in group else np.arange(steps)
                step = float(np.asarray(group.attrs.get("time_step", 1.0)).item())
                start = float(np.asarray(group.attrs.get("time_start", 0.0)).item())
                parts[name].append(start + step * np.asarray(count, dtype=float))
                continue
            packed = data[:steps, place - 1]
            values = np.asarray(packed, dtype=float)
            if np.issubdtype(packed.dtype, np.integer):
                values[packed == np.iinfo(packed.dtype).max] = np.nan
            if "gains" in group:
                values *= float(group["gains"][:][place - 1])
            if "offsets" in group:
                values += float(group["offsets"][:][place - 1])
            parts[name].append(values)
        read += steps
    return {name: np.concatenate(parts[name]) for name in places}
