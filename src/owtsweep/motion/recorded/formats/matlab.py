"""Read MATLAB files (.mat) of versions 4 to 7: arrays of real numbers alone.

Structures, cells, objects and functions are never loaded, so nothing in a file can run code.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.recorded.formats.arrays import name_columns
from owtsweep.motion.recorded.formats.matlab_layout import (
    Damaged,
    Variable,
    list_variables,
    load_variable,
)
from owtsweep.motion.recorded.formats.table import ChannelTable, refuse, require_room, shorten

#: The beginning of an HDF5 file, which MATLAB 7.3 puts behind a header of its own.
HDF5, HEADER = b"\x89HDF\r\n\x1a\n", 512


def open_mat(path: Path) -> ChannelTable:
    """Open a MATLAB file.

    A vector `a` becomes the channel a, whether it lies or stands. The longer side of a matrix is
    taken for its rows in time; its columns become channels as in `arrays.open_npz`: a_x, a_y, a_z,
    or a_1, a_2, ... Variables may differ in their length; only those that are loaded together may
    not. All that is no array of real numbers, and numbers that stand alone, are left out.

    Raises
    ------
    InputError
        If the file is damaged, of version 7.3, or has no array of numbers. When numbers are loaded,
        `InputError` is raised if channels differ in length.
    """
    _refuse_hdf5(path)
    places: dict[str, tuple[Variable, int]] = {}  # channel -> variable, column
    left_out = []
    with _reading(path):
        variables = list_variables(path)
    for variable in variables:
        shape = variable.shape
        if not variable.real or len(shape) != 2 or min(shape) < 1 or max(shape) < 2:
            left_out.append(variable.name)
            continue
        require_room(path, max(shape), min(shape), max(shape))
        name, columns = variable.name, min(shape)
        channels = [name] if columns == 1 else name_columns(path, name, columns)
        places.update({each: (variable, column) for column, each in enumerate(channels)})
    listed = f"no arrays of real numbers, left out: {', '.join(left_out)}" if left_out else ""
    if not places:
        raise refuse(
            path, f"has no vector of numbers: save plain vectors{listed and f' ({listed})'}"
        )

    def load(names: Sequence[str], rows: int | None) -> Mapping[str, Array]:
        lengths = {name: max(places[name][0].shape) for name in names}
        if len(set(lengths.values())) > 1:
            told = ", ".join(f"{name} {length}" for name, length in lengths.items())
            raise refuse(path, f"channels differ in length ({told}): save them equally long")
        result: dict[str, Array] = {}
        for variable in dict.fromkeys(places[name][0] for name in names):
            with _reading(path):
                array = load_variable(path, variable)
            table = array if array.shape[0] >= array.shape[1] else array.T
            for name in names:
                if places[name][0] == variable:
                    result[name] = np.array(table[:rows, places[name][1]])
        return result

    longest = max(max(variable.shape) for variable, _ in places.values())
    units = ("",) * len(places)
    notes = [listed] if listed else []
    return ChannelTable(path, "MATLAB", tuple(places), units, load, longest, notes)


def _refuse_hdf5(path: Path) -> None:
    with path.open("rb") as file:
        begin = file.read(HEADER + len(HDF5))
    if begin.startswith((b"MATLAB 7.3", HDF5)) or begin[HEADER:] == HDF5:
        raise refuse(
            path,
            "is of MATLAB's version 7.3 (HDF5), which is not read: save it again with "
            "save('NAME.mat', 'time', 'x', ..., '-v7'), or convert it to CSV",
        )


@contextmanager
def _reading(path: Path) -> Iterator[None]:
    """Turn what is wrong with a file into an `InputError` that names it."""
    try:
        yield
    except Damaged as error:
        raise refuse(path, f"is not a whole MATLAB file ({shorten(error)})") from None
