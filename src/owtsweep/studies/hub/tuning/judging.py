"""Judges tunings on records: the same records before and after, of a seed used in no search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import attrgetter

import numpy as np
import pandas as pd

from owtsweep.arrays import Array
from owtsweep.config import changed
from owtsweep.errors import InputError
from owtsweep.statistics.contrasts import gap
from owtsweep.studies.base import blocks
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.declaration import find_declaration
from owtsweep.studies.hub.listed import resolve
from owtsweep.studies.hub.tuning.objective import amplitudes, score
from owtsweep.studies.hub.winners import make_cube

#: Window of a record that judges: a tuning says how an estimator runs on, not how it starts.
WINDOW = "settled"


@dataclass(frozen=True)
class Gain:
    """The change of a scheme's error from one tuning to another, on the same records.

    Attributes
    ----------
    before, after
        Geometric mean over natural periods and amplitudes of the settled MSE, m^2 or (m/s)^2.
    change
        Geometric mean of after / before over records, natural periods and amplitudes, minus 1.
    low, high
        The 95 % interval of `change`, from the differences between the two, record by record.
    """

    before: float
    after: float
    change: float
    low: float
    high: float


def judge(before: HubConfig, after: HubConfig, schemes: Sequence[str]) -> dict[str, Gain]:
    """Run schemes with two tunings on the same records; return what each has gained.

    Records have the seed `seed` and the length `record.duration` of the configurations; there are
    `tune.replicates` of them per natural period.
    """
    count = before.tune.replicates
    errors = [errors_on_records(config, schemes, count) for config in (before, after)]
    return {name: _compare(*parts) for name, *parts in zip(schemes, *errors, strict=True)}


def _compare(before: Array, after: Array) -> Gain:
    """Compare the errors of one scheme, shape (periods, amplitudes, replicates) each."""
    ratios = np.mean(np.log(after / before), axis=(0, 1))
    logs = gap(ratios)
    changes = (float(np.expm1(value)) for value in (logs.value, logs.low, logs.high))
    return Gain(score(before.mean(axis=-1)), score(after.mean(axis=-1)), *changes)


def errors_on_records(config: HubConfig, schemes: Sequence[str], replicates: int) -> Array:
    """Run schemes on records; return their settled MSE by `measures.criterion`.

    Returns
    -------
    array
        Shape (schemes, periods, amplitudes, replicates), m^2 or (m/s)^2.

    Raises
    ------
    InputError
        If a case fails.
    """
    entries = [entry for entry in config.schemes if resolve(entry).name in schemes]
    grid = changed(config.grid, amplitude=amplitudes(config).tolist(), replicates=replicates)
    part = changed(config, engine="batch", grid=grid, schemes=entries, baselines=[])
    declaration, rows = find_declaration(part), []
    for _, group in groupby(blocks.plan(declaration, part), attrgetter("group")):
        rows += [table for _, table in blocks.run(declaration, part, list(group))]
    cube = make_cube(part, pd.concat(rows, ignore_index=True))
    place = (cube.measures.index(part.measures.criterion), cube.windows.index(WINDOW))
    numbers = [cube.schemes.index(name) for name in schemes]
    errors = np.array(
        [[cube.values(i, outer)[:, *place] for outer in cube.outer_places()] for i in numbers]
    )
    if not np.all(np.isfinite(errors)):
        raise InputError("tuning: a scheme's estimates on the records are not finite; try another")
    return errors
