"""Computes what tunings are judged by: schemes' settled errors over periods and amplitudes.

Expected errors (`studies.hub.expected`) need no record, so no random number decides between two
tunings. Other errors are those on records, the same ones for all tunings.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from operator import attrgetter

import numpy as np
import pandas as pd

from owtsweep.arrays import Array
from owtsweep.config import changed
from owtsweep.errors import InputError
from owtsweep.results.superposition import superpose
from owtsweep.studies.base.blocks import DeclaredBlocks
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known, Scheme
from owtsweep.studies.hub.declaration import find_declaration
from owtsweep.studies.hub.describe import make_cube
from owtsweep.studies.hub.error_curves.curves import curves
from owtsweep.studies.hub.error_curves.of_schemes import motion_of, noise_of
from owtsweep.studies.hub.listed import resolve

#: Length of the records of whose settled part the errors are the mean, and the part left out, s. A
#: tuning is judged by how an estimator runs on, not by how it starts: the bias takes up to 100 s.
DURATION = 300.0
SETTLING = 100.0
#: Name of that part in the rows of a run.
WINDOW = "settled"
#: Number of amplitudes between the ends of the range that is tuned for.
AMPLITUDES = 7


def amplitudes(config: HubConfig) -> Array:
    """Return the amplitudes that a tuning is judged at, m: the range's ends and five between."""
    low, high = config.tune.amplitude or (min(config.grid.amplitude), max(config.grid.amplitude))
    return np.geomspace(low, high, AMPLITUDES) if high > low else np.array([low])


def has_curves(scheme: Scheme) -> bool:
    return scheme.linear and scheme.batched == "chain"


def expected_errors(config: HubConfig, scheme: Scheme) -> Array:
    """Compute a scheme's settled MSE, m^2 or (m/s)^2, shape (periods, amplitudes).

    Raises ValueError or ArithmeticError if the scheme cannot be computed with this tuning.
    """
    sensors = sensing.sensors(config.sensors)
    steps, settled = (round(seconds / sensors.step) for seconds in (DURATION, SETTLING))
    chain = scheme.kernel(Known(sensors, config), steps)
    curve = curves(chain, sensors, steps=steps, settled=settled, band=config.band)
    measure, shares = _parts(config)
    motion = motion_of(config, curve, config.grid.natural_period)[:, measure, 1]
    noise = noise_of(config, sensors, curve)[:, measure, 1]
    cells = [
        superpose(share * motion[:, None], 0.0, floor, amplitudes(config))
        for share, floor in zip(shares, noise, strict=True)
        if share is not None
    ]
    return np.asarray(np.sum(cells, axis=0))


def _parts(config: HubConfig) -> tuple[int, tuple[float | None, float | None]]:
    """Return the criterion's index, and each axis' share of the motion; None if it is left out."""
    angle = np.deg2rad(config.wave_direction)
    x, y = float(np.cos(angle) ** 2), float(np.sin(angle) ** 2)
    criterion = config.measures.criterion
    shares = {"x": (x, None), "y": (None, y)}.get(criterion, (x, y))
    return int(criterion == "velocity"), shares


def errors_on_records(config: HubConfig, schemes: Sequence[str], replicates: int) -> Array:
    """Run schemes on records; return their settled MSE by `measures.criterion`.

    The shape is (schemes, periods, amplitudes, replicates). Raises InputError if a case fails.
    """
    entries = [entry for entry in config.schemes if resolve(entry).name in schemes]
    grid = changed(config.grid, amplitude=amplitudes(config).tolist(), replicates=replicates)
    part = changed(config, engine="batch", grid=grid, schemes=entries, baselines=[])
    blocks, rows = DeclaredBlocks(find_declaration(part)), []
    for _, group in groupby(blocks.plan(part), attrgetter("group")):
        rows += [table for _, table in blocks.run(part, list(group))]
    cube = make_cube(part, pd.concat(rows, ignore_index=True))
    place = (cube.measures.index(part.measures.criterion), cube.windows.index(WINDOW))
    numbers = [cube.schemes.index(name) for name in schemes]
    errors = np.array(
        [[cube.values(i, outer)[:, *place] for outer in cube.outer_places()] for i in numbers]
    )
    if not np.all(np.isfinite(errors)):
        raise InputError("tuning: a scheme's estimates on the records are not finite; try another")
    return errors


def score(errors: Array) -> float:
    """Return the geometric mean of the errors of all cells, in their unit; NaN if one is.

    The geometric mean weighs a percent less the same in each cell, whatever the cell's error.
    """
    with np.errstate(all="ignore"):
        return float(np.exp(np.mean(np.log(errors))))
