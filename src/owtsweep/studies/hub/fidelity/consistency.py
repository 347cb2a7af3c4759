"""Whether a tuning knows its own errors: NEES and NIS of every scheme and cell.

A consistent filter has a mean NEES of 4 (x, y, v_x, v_y) and a mean NIS of 2 (one fix); more means
that its covariance is too small (optimistic), less that it is too large (pessimistic).
Source: Bar-Shalom, Li and Kirubarajan (2001), Estimation with applications, section 5.4.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from owtsweep.studies.hub.fidelity.evidence import Cell, Evidence
from owtsweep.verdicts.inference import UNDECIDED, mean_ratio

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = (
    "scheme", "natural_period", "amplitude", "nees", "nees_low", "nees_high", "nis", "nis_low",
    "nis_high", "verdict",
)  # fmt: skip
#: Degrees of freedom of the two measures.
FREEDOM = {"nees": 4.0, "nis": 2.0}
OPTIMISTIC, CONSISTENT, PESSIMISTIC = "optimistic", "consistent", "pessimistic"
#: An interval that reaches beyond this factor says nothing about consistency.
WIDEST = 2.0
MIXED, UNKNOWN = "mixed", "unknown"


def consistency(evidence: Evidence) -> pd.DataFrame:
    """NEES / 4 and NIS / 2 in every cell of the run, and the verdict on them.

    Returns
    -------
    DataFrame
        `COLUMNS`: means over the records with their 95 % t intervals, 1 for a consistent filter,
        NaN where the scheme reports no covariance or no innovation. `verdict`: optimistic where an
        interval lies above 1 and none below, pessimistic the other way round, mixed where one lies
        above and one below, consistent where all hold 1, undecided where one of these is wider
        than a factor of 2 to either side, unknown without an interval.
    """
    import pandas as pd

    rows = []
    for scheme in evidence.schemes:
        for period in sorted(evidence.periods):
            for amplitude in sorted(evidence.amplitudes):
                row: dict[str, object] = dict(
                    zip(COLUMNS[:3], (scheme, period, amplitude), strict=True)
                )
                intervals = []
                for measure, freedom in FREEDOM.items():
                    samples = evidence.samples(scheme, Cell(period, amplitude), measure)
                    mean, low, high = np.nan, np.nan, np.nan
                    if samples is not None:
                        ratio = mean_ratio("", samples, freedom, 1.0, "above")
                        mean, low, high = ratio.value, ratio.low, ratio.high
                    row |= {measure: mean, f"{measure}_low": low, f"{measure}_high": high}
                    intervals.append((low, high))
                rows.append(row | {"verdict": verdict(intervals)})
    return pd.DataFrame(rows, columns=list(COLUMNS))


def verdict(intervals: list[tuple[float, float]]) -> str:
    """The verdict on the intervals of one cell, NaN for unknown ones."""
    finite = [(low, high) for low, high in intervals if np.isfinite(low)]
    above = any(low > 1.0 for low, _ in finite)
    below = any(high < 1.0 for _, high in finite)
    if not finite:
        return UNKNOWN
    if above and below:
        return MIXED
    if above or below:
        return OPTIMISTIC if above else PESSIMISTIC
    tight = all(low >= 1.0 / WIDEST and high <= WIDEST for low, high in finite)
    return CONSISTENT if tight else UNDECIDED
