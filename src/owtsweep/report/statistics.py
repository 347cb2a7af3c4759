"""What a page holds of a cell's records: means and covariances of all contenders, look by look.

A page computes errors, and paired intervals of their differences, for any amplitude, window and
number of records from these alone. Their size does not grow with the number of records.
"""

from __future__ import annotations

from collections.abc import Iterator
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


def list_looks(
    cube: Cube, name: str, criterion: Criterion, window: str, *, means_only: bool = False
) -> Iterator[list[Look]]:
    """Yield the looks of each cell, in the order of the cube's levels, the last axis fastest.

    With superposed rows, one list serves all values of the last condition.

    means_only: whether each cell has a single look without covariances.
    """
    measure, at = cube.measures.index(name), cube.windows.index(window)
    superposed = is_superposed(cube)
    for place in cube.outer_places():
        if superposed:
            assert cube.products is not None
            here: tuple[int | slice[None, None, None], ...] = (slice(None), slice(None), *place)
            products = cube.products[here][:, :, measure, at]
            yield _find_looks(products.transpose(1, 0, 2), means_only)
            continue
        values = np.stack(
            [cube.values(i, place, [measure])[:, 0, at] for i in range(len(cube.schemes))]
        )
        for of_cell in criterion.judge(values).transpose(1, 0, 2):
            yield _find_looks(of_cell[:, np.newaxis], means_only)


def gather_records(
    cube: Cube, name: str, criterion: Criterion, window: str
) -> tuple[Array, tuple[int, ...]]:
    """Return what is judged of the first `MOST_RECORDS` records of each cell, and its shape.

    The shape is (cells, schemes, 1 or 3, records), with cells as in `list_looks`; NaN where a
    scheme has no value. The three are motion, cross and noise of superposed rows.
    """
    measure, at = cube.measures.index(name), cube.windows.index(window)
    shown = slice(None, MOST_RECORDS)
    if is_superposed(cube):
        assert cube.products is not None
        products = cube.products[..., measure, at, shown]  # 3, schemes, outer conditions, records
        cells = np.moveaxis(products, (0, 1), (-2, -3))
    else:
        every = [
            np.stack([cube.values(i, place, [measure])[:, 0, at, shown] for i in range(count)])
            for count in [len(cube.schemes)]
            for place in cube.outer_places()
        ]
        cells = np.moveaxis(criterion.judge(np.array(every)), 1, 2)[..., np.newaxis, :]
    whole = cells.reshape(-1, *cells.shape[-3:])
    return whole, whole.shape


def _find_looks(values: Array, means_only: bool) -> list[Look]:
    """Return the looks of a cell; `values` has the shape (schemes, 1 or 3, records)."""
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
