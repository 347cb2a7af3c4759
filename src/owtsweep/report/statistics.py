"""What a page holds of a cell's records: means and covariances of all contenders, look by look.

A page computes errors, and paired intervals of their differences, for any amplitude, window and
number of records from these alone. Their size does not grow with the number of records.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.results.criteria import Criterion
from owtsweep.results.cube import Cube
from owtsweep.statistics.deciding import LOOKS

#: Most records that a page has one by one, on request.
MOST_RECORDS = 32


class Look(NamedTuple):
    """Statistics of the first records of a cell.

    records: how many these are.
    schemes: indices, in the cube, of those that have a value in each of these records.
    mean: Means of what is judged, shape (p,). With superposed rows, p is three per scheme: motion,
        cross and noise (`results.superposition`); else one per scheme.
    factor: R of a QR decomposition of the centred values over sqrt(records - 1), shape (k, p):
        R^T R is their covariance. Unlike the covariance, it keeps small differences of schemes
        that nearly coincide through rounding to 32 bits. k is 0 with a single record.
    """

    records: int
    schemes: list[int]
    mean: Array
    factor: Array


def is_superposed(cube: Cube) -> bool:
    """Return whether every value is computed from superposed rows, so at any amplitude."""
    return cube.products is not None and cube.direct is None


def gather_records(cube: Cube, name: str, criterion: Criterion, window: str) -> Array:
    """Return what is judged of each record, shape (cells, schemes, 1 or 3, records).

    Cells are in the order of the cube's levels, the last axis fastest; with superposed rows one
    cell serves all values of the last condition, and the three are motion, cross and noise. NaN
    stands where a scheme has no value.
    """
    if is_superposed(cube):
        assert cube.products is not None
        measure, at = cube.measures.index(name), cube.windows.index(window)
        products = cube.products[..., measure, at, :]  # 3, schemes, outer conditions, records
        cells = np.moveaxis(products, (0, 1), (-2, -3))
    else:
        values = np.array([cube.values_of(place, name, window) for place in cube.outer_places()])
        cells = np.moveaxis(criterion.judge(values), 1, 2)[..., np.newaxis, :]
    return cells.reshape(-1, *cells.shape[-3:])


def find_looks(values: Array, *, means_only: bool = False) -> list[Look]:
    """Return the looks of a cell.

    values: those of one cell in `gather_records`, shape (schemes, 1 or 3, records).
    means_only: whether there is a single look, without covariances.
    """
    there: NDArray[np.bool_] = np.all(np.isfinite(values), axis=1)
    most = int(np.flatnonzero(np.any(there, axis=0)).max(initial=-1)) + 1
    counts = [count for count in LOOKS if count < most] + [most] * (most > 0)
    looks: list[Look] = []
    seen: set[int] = set()
    for count in [most] if means_only else counts:
        chosen = [i for i in range(len(values)) if there[i, :count].all()]
        if chosen:
            looks.append(_summarise(values, chosen, np.arange(count), means_only))
            seen.update(chosen)
    for i in range(len(values)):  # it failed in some record, so it can be paired with nobody
        records = np.flatnonzero(there[i])
        if i not in seen and len(records):
            looks.insert(0, _summarise(values, [i], records, means_only))
    return looks


def _summarise(
    values: Array, chosen: list[int], records: NDArray[np.intp], means_only: bool
) -> Look:
    used = values[chosen][:, :, records].reshape(-1, len(records))
    mean = used.mean(axis=1)
    factor = np.empty((0, len(mean)))
    if len(records) > 1 and not means_only:
        centred = (used - mean[:, np.newaxis]).T / np.sqrt(len(records) - 1.0)
        factor = np.asarray(np.linalg.qr(centred, mode="r"))
    return Look(len(records), chosen, mean, factor)
