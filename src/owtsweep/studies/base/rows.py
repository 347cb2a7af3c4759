"""The rows of a block: what a scheme's estimates of some records are worth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Generic, NamedTuple, TypeVar

import numpy as np

from owtsweep.arrays import Array
from owtsweep.results.conditions import Value
from owtsweep.results.status import OK
from owtsweep.results.superposition import PRODUCTS
from owtsweep.studies.base.contest import WINDOW

if TYPE_CHECKING:
    import pandas as pd


class Means(NamedTuple):
    """Mean squares over a record, as products of the errors from motion and from noise.

    measures, windows: Names, n entries each.
    products: Means of motion x motion, motion x noise, noise x noise, shape (n, 3). The last is the
        mean square itself if motion and noise were run as one series.
    n_samples: Number of samples in each mean, n numbers.
    """

    measures: Sequence[str]
    windows: Sequence[str]
    products: Array
    n_samples: Sequence[int]


F = TypeVar("F")


class Judgement(NamedTuple, Generic[F]):
    """What a scheme's estimates of a record are worth, or why there are none.

    `found` has measure -> value, or `Means`; `status` and `reason` are as in rows
    (`owtsweep.results.status`).
    """

    found: F | None
    status: str = OK
    reason: str = ""


class Labels(NamedTuple):
    """What the rows of a block are of: a scheme, a cell, and some records by their numbers.

    `cell` has the values of axes on which the rows depend; `axes` are the names of all.
    """

    scheme: str
    cell: Mapping[str, Value]
    axes: Sequence[str]
    replicates: Sequence[int]


def make_rows(labels: Labels, judged: Sequence[Judgement[Mapping[str, float]]]) -> pd.DataFrame:
    """Return the rows of a block, one per record and measure; an axis that is not set is NaN."""
    found = [part.found or {"": np.nan} for part in judged]
    windows = [WINDOW if part.status == OK else "" for part in judged]
    counts = [len(each) for each in found]
    columns = {
        "measure": [name for each in found for name in each],
        "window": np.repeat(windows, counts),
        "value": [value for each in found for value in each.values()],
    }
    return _join(labels, judged, counts, columns)


def make_product_rows(
    labels: Labels, judged: Sequence[Judgement[Means]], *, apart: bool
) -> pd.DataFrame:
    """Return the rows of a block of products; parameters as for `make_rows`.

    If motion and noise were run `apart`, a row has the columns motion, cross and noise, and stands
    for all values of the axis that scales the motion. Otherwise it has a value.
    """
    nothing = Means([""], [""], np.full((1, 3), np.nan), [0])
    found = [part.found or nothing for part in judged]
    products = np.concatenate([each.products for each in found]).T
    none = np.full_like(products, np.nan)
    counts = [len(each.measures) for each in found]
    columns = {
        "measure": [name for each in found for name in each.measures],
        "window": [name for each in found for name in each.windows],
        **dict(zip(PRODUCTS, products if apart else none, strict=True)),
        "value": none[0] if apart else products[2],
        "n_samples": [count for each in found for count in each.n_samples],
    }
    return _join(labels, judged, counts, columns)


def _join(
    labels: Labels,
    judged: Sequence[Judgement[F]],
    counts: Sequence[int],
    columns: Mapping[str, object],
) -> pd.DataFrame:
    """Put labels before the columns of measures, and status and reason behind."""
    import pandas as pd

    values = {axis: labels.cell.get(axis, np.nan) for axis in labels.axes}
    return pd.DataFrame(
        {
            **{axis: v if isinstance(v, str) else float(v) for axis, v in values.items()},
            "scheme": labels.scheme,
            "replicate": np.repeat(labels.replicates, counts),
            **columns,
            "status": np.repeat([part.status for part in judged], counts),
            "reason": np.repeat([part.reason for part in judged], counts),
        }
    )
