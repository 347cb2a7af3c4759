"""Changes from one run to another: best schemes per cell, and each scheme's MSE."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.results.conditions import Value
from owtsweep.statistics.contrasts import difference, gap, ratio
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
) -> list[dict[str, Any]]:
    """The cells that change their best scheme from the first run to the second.

    Where P is best in the first run and Q in the second, the gap is MSE(Q) - MSE(P): positive
    there, negative here. A change is established if both gaps differ from zero: the larger of the
    two p-values (an intersection-union test) under Holm's correction over all common cells.

    Parameters
    ----------
    first, second
        The results of `common.arrange_samples` for both runs, with the same rows and columns.
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
    cells = [cell for cell in best_first if cell in best_second]
    names = list(map(str, first.index.names[1:]))
    rows, p_values = [], []
    for cell in cells:
        P, Q = best_first[cell], best_second[cell]
        if P == Q:
            p_values.append(1.0)
            continue
        before, after = (
            (table.loc[(Q, *cell), :] - table.loc[(P, *cell), :]).to_numpy(dtype=float)
            for table in (first, second)
        )
        gaps = gap(before), gap(after)
        change = difference(before, after, paired=paired)
        row: dict[str, Any] = {**dict(zip(names, cell, strict=True)), "best_from": P, "best_to": Q}
        for name, contrast in (("gap_from", gaps[0]), ("gap_to", gaps[1]), ("change", change)):
            row[name] = float(contrast.value)
            row[f"{name}_low"], row[f"{name}_high"] = float(contrast.low), float(contrast.high)
        row |= {"n_from": int(gaps[0].n_first), "n_to": int(gaps[1].n_first)}
        opposite = row["gap_from"] > 0.0 > row["gap_to"]
        p_values.append(max(float(gaps[0].p), float(gaps[1].p)) if opposite else 1.0)
        rows.append((len(p_values) - 1, row))
    verdicts = holm(p_values)
    return [row | {"established": bool(verdicts[index])} for index, row in rows]


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
    mean_a, mean_b = gap(a).value, gap(b).value
    change, times = difference(a, b, paired=paired), ratio(a, b, paired=paired)
    told = np.where(change.value < 0.0, "better", "worse")
    table = first.index.to_frame(index=False).assign(
        mse_from=mean_a,
        mse_to=mean_b,
        difference=change.value,
        difference_low=change.low,
        difference_high=change.high,
        ratio=times.value,
        ratio_low=times.low,
        ratio_high=times.high,
        n_from=change.n_first,
        n_to=change.n_second,
        verdict=np.where(holm(change.p.tolist()), told, ""),
    )
    return table[np.isfinite(change.value)].to_dict("records")
