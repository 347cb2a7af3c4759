"""Say in one sentence which scheme a replay of one record recommends: the last line it prints."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import pandas as pd

#: What the root of a criterion's mean square is called.
ERRORS = {
    "position": "position error",
    "velocity": "velocity error",
    "fix_residual": "distance from later fixes",
}


def recommend(advised: pd.DataFrame) -> str:
    """Write the recommendation for one record as one sentence; "" if there is no advice.

    The record's own errors, or its fixes, count before the expected map. `advised` is the table of
    advice of a run with a single record.
    """
    if advised.empty:
        return ""
    own = advised[advised["source"] != "map"]
    row = (own if len(own) else advised).iloc[0]
    unit = "m/s" if row["criterion"] == "velocity" else "m"
    what = ERRORS.get(row["criterion"], f"error of {row['criterion']}")
    size = f"its {what} is {np.sqrt(row['value_best']):.3g} {unit} (root mean square)"
    if not isinstance(row["runner_up"], str) or not row["runner_up"]:
        return f"recommended: run {row['best']}; {size}"
    other = f"that of {row['runner_up']} {np.sqrt(row['value_runner_up']):.3g} {unit}"
    if row["matters"]:
        return f"recommended: run {row['best']}; {size}, {other}"
    return f"recommended: run {row['best']}, but the difference does not matter; {size}, {other}"
