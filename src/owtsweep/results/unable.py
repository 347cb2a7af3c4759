"""Lists schemes that were unable to work in a cell, and shows them in tables.

A cell is one combination of conditions.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.results.conditions import Condition, Grid
from owtsweep.results.status import OK, UNABLE

if TYPE_CHECKING:
    import pandas as pd


def list_unable(rows: pd.DataFrame, conditions: Sequence[Condition], grid: Grid) -> pd.DataFrame:
    """List the cells in which schemes were unable to work: scheme, conditions, reason.

    A cell is one combination of conditions. A row in which the last condition expands and is NaN
    stands for all values that the grid has for this condition.
    """
    import pandas as pd

    keys = ["scheme", *(condition.name for condition in conditions)]
    left = rows[rows["status"] == UNABLE]
    if left.empty:
        return pd.DataFrame(columns=[*keys, "reason"])
    left = left[[*keys, "reason"]].astype({"scheme": object, "reason": object})
    last = conditions[-1]
    if last.expands:
        everywhere = left[left[last.name].isna()].drop(columns=last.name)
        every = everywhere.merge(pd.DataFrame({last.name: list(grid[last.name])}), how="cross")
        left = pd.concat([left[left[last.name].notna()], every[left.columns]])
    return left.drop_duplicates(keys, ignore_index=True)


def without_unable(rows: pd.DataFrame, conditions: Sequence[Condition]) -> pd.DataFrame:
    """Return the rows except those of schemes in cells in which they were unable to work.

    A cell is one combination of conditions. If a scheme was unable to work in one replicate of a
    cell, all its rows of this cell are left out.
    """
    import pandas as pd

    unable = rows["status"] == UNABLE
    if not unable.any():
        return rows
    keys = ["scheme", *(condition.name for condition in conditions)]
    cells = pd.MultiIndex.from_frame(rows[keys])
    return rows[~cells.isin(cells[unable.to_numpy()])]


def tell_in_summary(table: pd.DataFrame, unable: pd.DataFrame) -> pd.DataFrame:
    """Add to a summary the columns `status` and `reason`, and a line for each line of `unable`.

    The lines of schemes that were unable to work have neither measure nor mean. Lines are not
    sorted.
    """
    import pandas as pd

    told = table.assign(status=OK, reason="")
    lines = unable.assign(measure="", window="", n=0, status=UNABLE).reindex(columns=told.columns)
    return pd.concat([told, lines]) if len(told) else lines


def tell_in_best_scheme(
    table: pd.DataFrame, unable: pd.DataFrame, names: Sequence[str]
) -> pd.DataFrame:
    """Add `status` and `reason` to a best-scheme table if a scheme was unable to work in any cell.

    If there is no such scheme, return the table as it is. `unable` is what `list_unable` returns;
    `names` are the names of the conditions.
    """
    if unable.empty:
        return table
    who = unable["scheme"] + ": " + unable["reason"]
    reasons = who.groupby([unable[name] for name in names]).agg("; ".join).rename("reason")
    told = table.merge(reasons, how="left", left_on=list(names), right_index=True)
    told["reason"] = told["reason"].fillna("")
    told["status"] = [UNABLE if reason else OK for reason in told["reason"]]
    return told[[*table.columns, "status", "reason"]]
