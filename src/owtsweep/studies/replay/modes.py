"""Say in words which peaks the spectrum of a record has, and which of them the fit leaves out."""

from __future__ import annotations

from typing import Any

import numpy as np

from owtsweep.motion.modes import LEAST_SHARE, LEVEL
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.facts import MOST_MODES


def describe_modes(config: ReplayConfig, record: Any) -> str:
    """Name the peaks of a record's spectrum: period, share of the variance, whether in the band.

    `record` is the record's row of records.csv. Returns "" if the row was stored before peaks were
    searched for.
    """
    if not np.isfinite(record.get("slow_share", np.nan)):
        return ""
    low, high = config.fit_band
    told = []
    for number in range(1, MOST_MODES + 1):
        period = float(record.get(f"mode_{number}_period", np.nan))
        if np.isfinite(period):
            outside = "" if low <= 1.0 / period <= high else ", outside the band"
            share = 100.0 * record[f"mode_{number}_share"]
            told.append(f"{period:.3g} s ({share:.0f} % of the variance{outside})")
    text = f"peaks of the spectrum: {', '.join(told)}"
    if not told:
        text = f"the spectrum has no peak that is more than scatter (p < {LEVEL:g})"
    slow = float(record["slow_share"])
    if slow >= LEAST_SHARE:
        text += f"; {100.0 * slow:.0f} % of the variance has periods beyond "
        text += f"{record['slow_period']:.3g} s, too long for this record to time"
    return text
