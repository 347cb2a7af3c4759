"""Reads recorded loads on the top of a structure from a CSV file."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.io.reading import expand_home
from owtsweep.motion.recorded.checks import require_possible
from owtsweep.motion.recorded.formats.streams import TextStream


def read_loads(file: str, names: Sequence[str], *, steps: int, step: float) -> Array:
    """Read loads by columns, interpolated linearly at the samples of a record.

    Parameters
    ----------
    file
        A CSV file with a line of names: time (s), and the loads (N, N m).
    names
        Names of the loads' columns.
    steps, step
        Number of samples and sampling interval (s) of the record, which begins at the file's first
        time.

    Returns
    -------
    array
        Shape (steps, names).

    Raises
    ------
    InputError
        If the file cannot be read, lacks a column, holds something else than finite numbers or an
        absurdly large one, its times do not rise, or it is shorter than the record.
    """
    import pandas as pd

    path = expand_home(file)
    try:
        with TextStream(path) as stream:  # refuses devices, and what unpacks to too much
            table = pd.read_csv(stream)
    except (OSError, ValueError) as error:
        raise InputError(f"wind.file: {file} cannot be read ({error})") from None
    missing = [name for name in ("time", *names) if name not in table.columns]
    require(not missing, f"wind.file: {file} lacks the columns {', '.join(missing)}")
    values = table[["time", *names]].apply(pd.to_numeric, errors="coerce").to_numpy(dtype=float)
    require(len(values) > 0, f"wind.file: {file} holds no row of numbers below its names")
    bad = np.flatnonzero(~np.isfinite(values).all(axis=1))
    require(
        len(bad) == 0,
        f"wind.file: {file} has no number in line {bad[0] + 2 if len(bad) else 0}; remove or "
        "fill such lines",
    )
    for name, column in zip(names, values[:, 1:].T, strict=True):
        require_possible(
            f"wind.file: {file}: column {name}", column, "check its unit, N or N m", load=True
        )
    time = values[:, 0] - values[0, 0]
    require(bool(np.all(np.diff(time) > 0.0)), f"wind.file: times of {file} do not rise")
    length = (steps - 1) * step
    require(
        time[-1] >= length * (1.0 - 1e-9),
        f"wind.file: {file} holds {time[-1]:g} s, but record.duration asks for {length + step:g} s",
    )
    at = step * np.arange(steps)
    return np.stack([np.interp(at, time, column) for column in values[:, 1:].T], axis=1)
