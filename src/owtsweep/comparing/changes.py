"""Changes from one run to another: best scheme and boundary per cell, and each scheme's MSE."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.results.boundary import divide_crossings, split_cells
from owtsweep.results.conditions import Value
from owtsweep.statistics.contrasts import Contrast, difference, gap, ratio
from owtsweep.statistics.holm import holm

if TYPE_CHECKING:
    import pandas as pd

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

#: Cell (one value of each condition) -> name of the best scheme.
Winners = Mapping[tuple[Value, ...], str]


def list_winners(best: pd.DataFrame, names: Sequence[str]) -> dict[tuple[Value, ...], str]:
    """The best scheme per cell, from one run's table with these conditions."""
    cells = zip(*(best[name].tolist() for name in names), strict=True)
    return dict(zip(cells, best["best"].tolist(), strict=True))


def compare_cells(
    first: pd.DataFrame,
    second: pd.DataFrame,
    best_first: Winners,
    best_second: Winners,
    *,
    paired: bool,
) -> list[dict[Any, Any]]:
    """The cells that change their best scheme from the first run to the second.

    Where P is best in the first run and Q in the second, the gap is MSE(Q) - MSE(P): positive
    there, negative here. A change is established if both gaps differ from zero: the larger of the
    two p-values (an intersection-union test) under Holm's correction over all common cells.

    Parameters
    ----------
    first, second
        The `samples` of both runs (`common.Judged`), with the same rows and columns.
    best_first, best_second
        Their best schemes.
    paired
        Whether equal replicates saw the same motion and noise in both runs.

    Returns
    -------
    list of dict
        The conditions and `CHANGED_COLUMNS` except the criterion. `change` is the gap of the second
        run minus that of the first, with its (paired) interval.
    """
    import pandas as pd

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
        n_from=gap_from.n_first,
        n_to=gap_to.n_first,
        established=holm(p_values)[: len(cells)],
    )
    return table.to_dict("records")


def compare_schemes(
    first: pd.DataFrame, second: pd.DataFrame, *, paired: bool
) -> list[dict[Any, Any]]:
    """Per scheme and cell the difference and the ratio of MSE between two runs.

    Returns
    -------
    list of dict
        scheme, conditions and `SCHEME_COLUMNS` except the criterion. `verdict` is "better" or
        "worse" (the second run's MSE is smaller or larger) under Holm's correction over all rows of
        the pair, else "".
    """
    a, b = first.to_numpy(), second.to_numpy()
    if paired:
        both = np.isfinite(a) & np.isfinite(b)
        a, b = np.where(both, a, np.nan), np.where(both, b, np.nan)
    change = difference(a, b, paired=paired)
    told = np.where(change.value < 0.0, "better", "worse")
    table = first.index.to_frame(index=False).assign(
        mse_from=gap(a).value,
        mse_to=gap(b).value,
        **_name_columns("difference", change),
        **_name_columns("ratio", ratio(a, b, paired=paired)),
        n_from=change.n_first,
        n_to=change.n_second,
        verdict=np.where(holm(change.p), told, ""),
    )
    return table[np.isfinite(change.value)].to_dict("records")


def _name_columns(name: str, contrast: Contrast) -> dict[str, Any]:
    """The columns of an estimate and its interval."""
    return {name: contrast.value, f"{name}_low": contrast.low, f"{name}_high": contrast.high}


def compare_boundaries(
    first: pd.DataFrame, second: pd.DataFrame, *, paired: bool
) -> list[dict[Any, Any]]:
    """The boundary in the second run divided by that in the first, per cell of other conditions.

    The interval consists of percentiles of a bootstrap over the records. Paired runs share their
    draws, over the records that both schemes finished in both runs; otherwise each run has
    different draws.

    Parameters
    ----------
    first, second
        The results of `results.boundary.subtract_schemes` for both runs.
    paired
        As for `compare_cells`.

    Returns
    -------
    list of dict
        The other conditions and `SHIFT_COLUMNS`; only cells with a boundary in both runs.
    """
    if paired:
        common = first.index.intersection(second.index)
        first, second = first[first.index.isin(common)], second[second.index.isin(common)]
    outer = first.index.names[:-1]
    one, other = split_cells(first), split_cells(second)
    lines: list[dict[Any, Any]] = []
    for cell in one:
        if cell in other:
            quotient = divide_crossings((cell, other[cell]), (cell, one[cell]), apart=not paired)
            if not np.isnan(quotient[0]):
                lines.append(dict(zip([*outer, *SHIFT_COLUMNS], [*cell, *quotient], strict=True)))
    return lines
