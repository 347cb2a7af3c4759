"""The possible outcomes of a case, which are the values of the column `status`.

Tables show where a scheme was unable to work: in which cells, and why.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.results.conditions import Condition, Grid, spread

if TYPE_CHECKING:
    import pandas as pd

#: The case has a result.
OK = "ok"
#: The case failed; it is run again when the sweep is resumed.
FAILED = "failed"
#: The scheme cannot work under these conditions, for the reason given; this is its result.
UNABLE = "unable"


def list_unable(rows: pd.DataFrame, conditions: Sequence[Condition], grid: Grid) -> pd.DataFrame:
    """Return a table of the cells in which a scheme was unable to work.

    One line per scheme and cell; columns scheme, conditions, reason. A superposed row stands for
    all values that `grid` gives for the last condition.
    """
    import pandas as pd

    keys = ["scheme", *(condition.name for condition in conditions)]
    left = rows[rows["status"] == UNABLE]
    if left.empty:
        return pd.DataFrame(columns=[*keys, "reason"])
    left = left[[*keys, "reason"]].astype({"scheme": object, "reason": object})
    if conditions[-1].expands:
        left = spread(left, {keys[-1]: grid[keys[-1]]})
    return left.drop_duplicates(keys, ignore_index=True)


def without_unable(rows: pd.DataFrame, conditions: Sequence[Condition]) -> pd.DataFrame:
    """Return the rows without schemes in cells where they were unable in some replicate."""
    import pandas as pd

    unable = rows["status"] == UNABLE
    if not unable.any():
        return rows
    keys = ["scheme", *(condition.name for condition in conditions)]
    cells = pd.MultiIndex.from_frame(rows[keys])
    return rows[~cells.isin(cells[unable.to_numpy()])]
