"""Compute what changes from one run to another: best schemes, boundaries, each scheme's MSE."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence

import numpy as np
import pandas as pd

from owtsweep.arrays import Array
from owtsweep.results.boundary import divide_crossings, split_cells
from owtsweep.results.conditions import Value
from owtsweep.statistics.contrasts import Contrast, difference, gap, ratio
from owtsweep.statistics.inference import holm

#: The columns before the conditions, and the columns after them.
PAIR_COLUMNS = ("from_run", "to_run", "along", "paired")
CHANGED_COLUMNS = (
    "criterion", "best_from", "best_to", "gap_from", "gap_from_low", "gap_from_high", "gap_to",
    "gap_to_low", "gap_to_high", "change", "change_low", "change_high", "n_from", "n_to",
    "established",
)  # fmt: skip
SCHEME_COLUMNS = (
    "criterion", "mse_from", "mse_to", "difference", "difference_low", "difference_high", "ratio",
    "ratio_low", "ratio_high", "n_from", "n_to", "verdict",
)  # fmt: skip
SHIFT_COLUMNS = ("ratio", "ratio_low", "ratio_high")

#: Cell -> name of the best scheme.
Winners = Mapping[tuple[Value, ...], str]
#: A row of a table: column -> value.
Row = dict[Hashable, object]


def list_winners(best: pd.DataFrame, names: Sequence[str]) -> dict[tuple[Value, ...], str]:
    """Return the best scheme of every cell of a run; `names` are the conditions."""
    cells = zip(*(best[name].tolist() for name in names), strict=True)
    return dict(zip(cells, best["best"].tolist(), strict=True))


def compare_cells(
    first: pd.DataFrame,
    second: pd.DataFrame,
    best_first: Winners,
    best_second: Winners,
    *,
    paired: bool,
) -> list[Row]:
    """List the cells in which the best scheme of the first run is not best in the second.

    Let P be the cell's best scheme in the first run and Q in the second. The gap of a run is MSE(Q)
    - MSE(P) in that run. The change from P to Q is established if the gap is shown to be positive
    in the first run and negative in the second: the larger p-value of the two gaps (an
    intersection-union test) passes Holm's correction over all cells that have a best scheme in both
    runs.

    Return one row per changed cell: the conditions and `CHANGED_COLUMNS` without `criterion`.
    `change` is the gap in the second run minus the gap in the first; `_low` and `_high` are the
    ends of 95 % intervals.

    first, second: the MSE in the two runs: one row per scheme and cell, one column per replicate,
        NaN where a scheme did not finish a replicate. Both tables have the same rows and columns.
    paired: whether equal replicates have the same motion and noise in both runs.
    """
    common = [cell for cell in best_first if cell in best_second]
    cells = [cell for cell in common if best_first[cell] != best_second[cell]]
    if not cells:
        return []
    old, new = (
        first.index.get_indexer(pd.MultiIndex.from_tuples([(best[cell], *cell) for cell in cells]))
        for best in (best_first, best_second)
    )
    before, after = (
        samples[new] - samples[old] for samples in (first.to_numpy(), second.to_numpy())
    )
    gap_from, gap_to = gap(before), gap(after)
    opposite = (gap_from.value > 0.0) & (gap_to.value < 0.0)
    p_values = np.ones(len(common))
    p_values[: len(cells)] = np.where(opposite, np.maximum(gap_from.p, gap_to.p), 1.0)
    table = pd.DataFrame(cells, columns=first.index.names[1:]).assign(
        best_from=[best_first[cell] for cell in cells],
        best_to=[best_second[cell] for cell in cells],
        **_name_columns("gap_from", gap_from),
        **_name_columns("gap_to", gap_to),
        **_name_columns("change", difference(before, after, paired=paired)),
        n_from=np.isfinite(before).sum(axis=1),
        n_to=np.isfinite(after).sum(axis=1),
        established=holm(p_values)[: len(cells)],
    )
    return table.to_dict("records")


def compare_schemes(first: pd.DataFrame, second: pd.DataFrame, *, paired: bool) -> list[Row]:
    """Compute the difference and the ratio of each scheme's MSE between two runs, cell by cell.

    Parameters are as in `compare_cells`.

    Return one row per scheme and cell: scheme, conditions and `SCHEME_COLUMNS` without `criterion`.
    `difference` is second minus first, `ratio` second over first. `verdict` is "better" if the MSE
    is shown to be smaller in the second run, and "worse" if it is shown to be larger, both under
    Holm's correction over all rows; otherwise "". Rows without a finite difference are left out.
    """
    a, b = first.to_numpy(), second.to_numpy()
    if paired:
        both = np.isfinite(a) & np.isfinite(b)
        a, b = np.where(both, a, np.nan), np.where(both, b, np.nan)
    change = difference(a, b, paired=paired)
    words = np.where(change.value < 0.0, "better", "worse")
    table = first.index.to_frame(index=False).assign(
        mse_from=gap(a).value,
        mse_to=gap(b).value,
        **_name_columns("difference", change),
        **_name_columns("ratio", ratio(a, b, paired=paired)),
        n_from=np.isfinite(a).sum(axis=1),
        n_to=np.isfinite(b).sum(axis=1),
        verdict=np.where(holm(change.p), words, ""),
    )
    return table[np.isfinite(change.value)].to_dict("records")


def _name_columns(name: str, contrast: Contrast) -> dict[str, Array]:
    """Return the columns `<name>`, `<name>_low` and `<name>_high`: values and 95 % intervals."""
    return {name: contrast.value, f"{name}_low": contrast.low, f"{name}_high": contrast.high}


def compare_boundaries(first: pd.DataFrame, second: pd.DataFrame, *, paired: bool) -> list[Row]:
    """Compute the ratio of the boundaries in two runs, second run to first run, cell by cell.

    A cell is one value of each condition but the last. The ends of the 95 % interval are
    percentiles of a bootstrap over the records. If the runs are paired, each resample draws the
    same records for both runs, among those that both schemes finished in both runs. Otherwise each
    run's records are resampled independently.

    `first`, `second`: for each run, the difference of the two schemes' results in every record, as
    `results.boundary.subtract_schemes` returns it. `paired`: whether equal replicates have the same
    motion and noise in both runs.

    Return one row per cell with a boundary in both runs: the cell's conditions and `SHIFT_COLUMNS`.
    """
    if paired:
        common = first.index.intersection(second.index)
        first, second = first[first.index.isin(common)], second[second.index.isin(common)]
    outer = first.index.names[:-1]
    one, other = split_cells(first), split_cells(second)
    lines: list[Row] = []
    for cell in one:
        if cell in other:
            quotient = divide_crossings((cell, other[cell]), (cell, one[cell]), apart=not paired)
            if not np.isnan(quotient[0]):
                lines.append(dict(zip([*outer, *SHIFT_COLUMNS], [*cell, *quotient], strict=True)))
    return lines
