"""The values of a run as arrays: axes are schemes, conditions, measures, windows, replicates."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import require
from owtsweep.results.conditions import Condition, Grid, Value, order_values, require_usable
from owtsweep.results.status import OK, list_unable, without_unable
from owtsweep.results.superposition import PRODUCTS, superpose_all
from owtsweep.statistics.contest import find_common

if TYPE_CHECKING:
    import pandas as pd
    from numpy.typing import NDArray
    from pandas.api.extensions import ExtensionArray

__all__ = ["Cube"]

#: Largest number that is used: sums of squares of larger ones overflow.
LARGEST = 1e140
#: Most values of a cube per row, beside those of an ordinary one that lacks most of its rows.
_SPARSEST, _ORDINARY = 1000, 10_000_000


@dataclass(frozen=True)
class Cube:
    """The values of a run as arrays, with one axis each for scheme, conditions, measure and so on.

    An element is NaN where there is no value. "Outer conditions" are all but the last; each has an
    axis. The values at each amplitude, the last condition, are computed on request from the
    products in superposed rows, because they would not fit into memory.

    schemes, measures, windows, replicates: the labels of these axes.
    conditions, levels: the study's conditions, and the values of each condition.
    products: the columns `PRODUCTS` of superposed rows, shape (3, scheme, *outer, measure, window,
        replicate); None without superposed rows.
    direct: Values of rows that have a value of the last condition, shape (scheme, *conditions,
        measure, window, replicate); None without such rows.
    unable: Schemes that were unable to work under some conditions. One line per scheme and
        combination of conditions; columns scheme, conditions, reason.
    """

    schemes: tuple[str, ...]
    conditions: tuple[Condition, ...]
    levels: tuple[list[Value], ...]
    measures: tuple[str, ...]
    windows: tuple[str, ...]
    replicates: tuple[Value, ...]
    products: Array | None
    direct: Array | None
    unable: pd.DataFrame

    @property
    def empty(self) -> bool:
        """Whether the cube has no value at all."""
        return self.products is None and self.direct is None

    @property
    def names(self) -> list[str]:
        """The names of the conditions."""
        return [condition.name for condition in self.conditions]

    def outer_places(self) -> Iterator[tuple[int, ...]]:
        """Yield the combinations of the outer conditions as indices, the last one fastest."""
        if not self.empty:
            yield from np.ndindex(*(len(levels) for levels in self.levels[:-1]))

    def name_outer(self, place: tuple[int, ...]) -> dict[str, Value]:
        """Return condition -> value for the outer conditions; `place` holds their indices."""
        outer = zip(self.names, self.levels, place, strict=False)  # the last condition has no index
        return {name: levels[index] for name, levels, index in outer}

    def values(
        self, scheme: int, place: tuple[int, ...], measures: Sequence[int] | None = None
    ) -> Array:
        """Return the values of one scheme at one `place` (indices of the outer conditions).

        Axes: value of the last condition, measure (all, or those with the indices `measures`),
        window, replicate. Raise `ValueError` if the cube is empty.
        """
        here: tuple[int | slice[None, None, None], ...] = (scheme, *place)
        kept = slice(None) if measures is None else measures
        result: Array | None = None
        if self.products is not None:
            products = self.products[(slice(None), *here)][:, kept]
            result = superpose_all(products, self.levels[-1])
        if self.direct is not None:
            direct = self.direct[here][:, kept]
            result = direct if result is None else np.where(np.isfinite(direct), direct, result)
        if result is None:
            raise ValueError("the cube is empty")
        return result

    def values_of(
        self,
        place: tuple[int, ...],
        measure: str,
        window: str,
        schemes: Sequence[int] | None = None,
    ) -> Array:
        """Return the values of schemes at one `place` by one measure, in one window.

        Axes: scheme (all, or those with the indices `schemes`), value of the last condition,
        replicate. Raise `ValueError` if the cube is empty, or has no such measure or window.
        """
        index, at = self.measures.index(measure), self.windows.index(window)
        chosen = range(len(self.schemes)) if schemes is None else schemes
        return np.stack([self.values(i, place, [index])[:, 0, at] for i in chosen])

    def find_shared(self, place: tuple[int, ...]) -> NDArray[np.bool_]:
        """Return which records all schemes of a cell have, shape (last condition, replicates).

        A scheme without any record in a cell takes no part in it. `place` is as of `values`.
        """
        there = np.stack(
            [np.isfinite(self.values(i, place)).any(axis=(1, 2)) for i in range(len(self.schemes))]
        )
        return find_common(np.where(there, 0.0, np.nan))[1]

    def label(
        self, scheme: int, place: tuple[int, ...], indices: Sequence[NDArray[np.intp]]
    ) -> dict[str, object]:
        """Return the labels of some elements of `values(scheme, place)` as columns: name -> labels.

        The columns are scheme and conditions, then measure, window and replicate. `indices` has one
        array of indices for each axis of `values`; without that of the replicates, there is no such
        column.
        """
        import pandas as pd

        names = [self.names[-1], "measure", "window", "replicate"]
        inner = self.measures, self.windows, self.replicates
        axes: tuple[Sequence[Value], ...] = (self.levels[-1], *inner)
        columns: dict[str, object] = {"scheme": self.schemes[scheme], **self.name_outer(place)}
        for name, axis, index in zip(names, axes, indices, strict=False):
            columns[name] = pd.Index(axis).take(index)
        return columns

    def to_table(self) -> pd.DataFrame:
        """Make a table of one line per value that is not NaN.

        Columns: scheme, conditions, measure, window, replicate, value.
        """
        import pandas as pd

        columns = ["scheme", *self.names, "measure", "window", "replicate", "value"]
        parts = []
        for i, place in product(range(len(self.schemes)), self.outer_places()):
            values = self.values(i, place)
            present = np.nonzero(np.isfinite(values))
            part = self.label(i, place, present) | {"value": values[present]}
            parts.append(pd.DataFrame(part, columns=columns))
        return join_lines(parts, columns)

    def widen(self, measure: str, window: str) -> pd.DataFrame:
        """Return the values of one measure in one window: a column per replicate.

        There is a line for each scheme and combination of conditions that has a value, which are
        the index. NaN stands where there is none.
        """
        import pandas as pd

        names = ["scheme", *self.names]
        if measure not in self.measures or window not in self.windows:
            return pd.DataFrame(index=pd.MultiIndex.from_product([[] for _ in names], names=names))
        parts = []
        for place in self.outer_places():
            outer = ([value] for value in self.name_outer(place).values())
            lines = pd.MultiIndex.from_product([self.schemes, *outer, self.levels[-1]], names=names)
            values = self.values_of(place, measure, window).reshape(len(lines), -1)
            parts.append(pd.DataFrame(values, lines, self.replicates))
        return pd.concat(parts).dropna(how="all")

    @classmethod
    def of_rows(
        cls,
        rows: pd.DataFrame,
        schemes: Sequence[str],
        conditions: Sequence[Condition],
        grid: Grid,
        *,
        measures: Sequence[str] = (),
    ) -> Cube:
        """Make the cube from a run's rows; it takes a tenth of the memory of `to_table`.

        Raise `InputError` if the conditions cannot be used (`require_usable`), if two rows give a
        value for the same element, or if the labels of the rows do not fit together.

        rows: the rows of a run's cases. A row that failed, lacks a label (such as its window), or
            has no number up to `LARGEST` is left out. If a scheme was unable to work under a
            combination of conditions, all rows of that scheme and combination are left out.
        grid: if the last condition expands, rows at values of it that `grid` does not have are left
            out.
        measures: the order of measures in tables. Others follow alphabetically.
        """
        require_usable(conditions)
        unable = list_unable(rows[rows["scheme"].isin(list(schemes))], conditions, grid)
        rows = without_unable(rows, conditions)
        superposed, direct = _choose(rows, schemes, conditions, grid)
        used = superposed | direct
        names = [condition.name for condition in conditions]
        *outer, last = names
        inner = ["measure", "window", "replicate"]
        listed: dict[str, Sequence[Value]] = {**grid, "measure": measures}
        labels: dict[str, Sequence[Value]] = {"scheme": list(schemes)}
        for name in [*outer, *inner]:
            labels[name] = order_values(_of(rows, name, used).unique(), listed.get(name, ()))
        every = grid[last] if superposed.any() else _of(rows, last, direct)
        labels[last] = order_values(every, grid.get(last, ()))
        products = values = None
        if superposed.any():
            products = _arrange(rows, superposed, labels, ["scheme", *outer, *inner], PRODUCTS)
        if direct.any():
            values = _arrange(rows, direct, labels, ["scheme", *names, *inner], ["value"])[0]
        if products is not None and values is not None:
            both = np.isfinite(np.expand_dims(products[0], 1 + len(outer))) & np.isfinite(values)
            _require_once(not both.any())
        return cls(
            schemes=tuple(schemes),
            conditions=tuple(conditions),
            levels=tuple(list(labels[name]) for name in names),
            measures=tuple(map(str, labels["measure"])),
            windows=tuple(map(str, labels["window"])),
            replicates=tuple(labels["replicate"]),
            products=products,
            direct=values,
            unable=unable,
        )


def join_lines(parts: Sequence[pd.DataFrame], columns: Sequence[str]) -> pd.DataFrame:
    """Return one table with the lines of all tables; without any, an empty one with `columns`."""
    import pandas as pd

    filled = [part for part in parts if len(part)]
    return pd.concat(filled, ignore_index=True) if filled else pd.DataFrame(columns=list(columns))


def _choose(
    rows: pd.DataFrame, schemes: Sequence[str], conditions: Sequence[Condition], grid: Grid
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return masks of superposed rows to use, and of rows with one value of the last condition."""
    *outer, last = conditions
    finished = ((rows["status"] == OK) & rows["scheme"].isin(list(schemes))).to_numpy()
    for name in ("measure", "window", "replicate", *(c.name for c in outer)):
        finished = finished & _there(rows, name)
    direct = finished & _usable(rows, "value")
    if not last.expands:
        return np.zeros(len(rows), dtype=bool), direct
    at_one = rows[last.name].notna().to_numpy()
    superposed = finished & ~at_one
    for name in PRODUCTS:
        superposed &= _usable(rows, name)
    return superposed, direct & at_one & rows[last.name].isin(list(grid[last.name])).to_numpy()


def _usable(rows: pd.DataFrame, name: str) -> NDArray[np.bool_]:
    """Return a mask of the numbers in a column whose magnitude is at most `LARGEST`."""
    return np.asarray(np.abs(rows[name].to_numpy(dtype=float)) <= LARGEST)


def _there(rows: pd.DataFrame, name: str) -> NDArray[np.bool_]:
    """Return a mask of the values in a column that are neither missing nor infinite."""
    column = rows[name]
    there: NDArray[np.bool_] = column.notna().to_numpy()
    return there & np.isfinite(column.to_numpy()) if column.dtype.kind == "f" else there


def _arrange(
    rows: pd.DataFrame,
    chosen: NDArray[np.bool_],
    labels: Mapping[str, Sequence[Value]],
    axes: Sequence[str],
    columns: Sequence[str],
) -> Array:
    """Arrange numbers of the chosen rows as an array (columns, *axes), NaN where there is no row.

    `labels` maps each of `axes` to its labels in order; the column of the same name says where on
    the axis a row belongs. Raise `InputError` if two rows belong to the same element, or if the
    array would have far more elements than there are rows.
    """
    import pandas as pd

    place = np.zeros(int(chosen.sum()), dtype=np.intp)
    for name in axes:
        column = _of(rows, name, chosen)
        if pd.api.types.is_numeric_dtype(column):
            codes = np.searchsorted(np.asarray(labels[name]), np.asarray(column))
        else:
            texts = pd.Categorical(column)  # it may have more categories than `labels`
            codes = pd.Index(labels[name]).get_indexer(texts.categories)[texts.codes]
        place *= len(labels[name])
        place += codes
    size = math.prod(len(labels[name]) for name in axes)
    require(
        size <= max(_SPARSEST * place.size, _ORDINARY),
        f"rows: {place.size} values for an array of {size}; "
        "the labels of the rows do not fit together",
    )
    arrays = np.full((len(columns), *(len(labels[name]) for name in axes)), np.nan)
    for flat, name in zip(arrays.reshape(len(columns), -1), columns, strict=True):
        flat[place] = _of(rows, name, chosen)
    _require_once(np.count_nonzero(np.isfinite(arrays[0])) == place.size)
    return arrays


def _of(rows: pd.DataFrame, name: str, chosen: NDArray[np.bool_]) -> ExtensionArray:
    """Return the column `name` in the chosen rows; no copy if all rows are chosen."""
    column: ExtensionArray = rows[name].array
    return column if chosen.all() else column[chosen]


def _require_once(once: bool) -> None:
    require(once, "rows: two values for one case; give each case of a run once")
