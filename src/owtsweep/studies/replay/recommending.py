"""Say in one sentence which scheme a replay of one record recommends: the last line it prints."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from owtsweep.studies.hub.public import INSTEAD
from owtsweep.studies.replay.identification.rows import ESTIMATED

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

    The record's own errors, or its fixes, count before the expected map. If the record contradicts
    the stated noise, so that the schemes were run with the estimated noise too, that run counts.
    `advised` is the table of advice of a run with a single record.
    """
    if advised.empty:
        return ""
    own = advised[advised["source"] != "map"]
    if "noise" in own and (own["noise"] == ESTIMATED).any():
        own = own[own["noise"] == ESTIMATED]
    row = (own if len(own) else advised).iloc[0].dropna().to_dict()
    if not row.get("advises", True):
        return ""  # the map covers too little of the record
    unit = "m/s" if row["criterion"] == "velocity" else "m"
    what = ERRORS.get(row["criterion"], f"error of {row['criterion']}")
    chosen = row.get("recommended", row["best"])
    size = np.sqrt(row.get("value_recommended", row["value_best"]))
    what_to_do = f"{INSTEAD[chosen]} ({chosen})" if chosen in INSTEAD else f"run {chosen}"
    if row.get("noise") == ESTIMATED:
        what_to_do += " with the noise that the record shows (noise.csv), not the stated one"
    told = f"{what_to_do}; its {what} is {size:.3g} {unit}"
    told = f"recommended: {told} (root mean square)"
    best = [row["best"], *row.get("same_as", "").split()]
    if chosen not in best:
        return f"{told}, that of {row['best']} {np.sqrt(row['value_best']):.3g} {unit}"
    if not row.get("runner_up"):
        return told
    told += f", that of {row['runner_up']} {np.sqrt(row['value_runner_up']):.3g} {unit}"
    return told if row["matters"] else f"{told}; the difference does not matter"
