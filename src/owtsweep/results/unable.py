"""Schemes that cannot work in a cell (they leave it), and how tables show this."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.results.conditions import Condition, Grid
from owtsweep.results.status import OK, UNABLE

if TYPE_CHECKING:
    import pandas as pd


def list_unable(rows: pd.DataFrame, conditions: Sequence[Condition], grid: Grid) -> pd.DataFrame:
    """One line per scheme and cell that it left: scheme, conditions, reason.

    A row without a value of a condition that expands stands for all values of the grid.
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
    """The rows, except those of a scheme in a cell that it left in any replicate."""
    import pandas as pd

    unable = rows["status"] == UNABLE
    if not unable.any():
        return rows
    keys = ["scheme", *(condition.name for condition in conditions)]
    cells = pd.MultiIndex.from_frame(rows[keys])
    return rows[~cells.isin(cells[unable.to_numpy()])]


def tell_in_summary(table: pd.DataFrame, unable: pd.DataFrame) -> pd.DataFrame:
    """A summary with `status` and `reason`, and a line for each scheme and cell that it left.

    Such a line has neither measure nor mean. Lines are in no order.
    """
    import pandas as pd

    told = table.assign(status=OK, reason="")
    lines = unable.assign(measure="", window="", n=0, status=UNABLE).reindex(columns=told.columns)
    return pd.concat([told, lines]) if len(told) else lines


def tell_in_best_scheme(
    table: pd.DataFrame, unable: pd.DataFrame, names: Sequence[str]
) -> pd.DataFrame:
    """A best-scheme table; with `status` and `reason` if a scheme left any cell."""
    if unable.empty:
        return table
    who = unable["scheme"] + ": " + unable["reason"]
    reasons = who.groupby([unable[name] for name in names]).agg("; ".join).rename("reason")
    told = table.merge(reasons, how="left", left_on=list(names), right_index=True)
    told["reason"] = told["reason"].fillna("")
    told["status"] = [UNABLE if reason else OK for reason in told["reason"]]
    return told[[*table.columns, "status", "reason"]]
