"""Judge in every cell whether a scheme's covariances agree with its errors, by NEES and NIS.

A cell is a combination of conditions in the run's grid. NEES is the normalized estimation error
squared, NIS the normalized innovation squared. A consistent filter has a mean NEES equal to the
number of judged states, and a mean NIS equal to the number of measured quantities. A larger mean
shows that the filter's covariance is too small (optimistic). A smaller mean shows that the
covariance is too large (pessimistic).
Source: Bar-Shalom, Li and Kirubarajan (2001), Estimation with applications, section 5.4.
"""

from __future__ import annotations

from itertools import product

import numpy as np
import pandas as pd

from experiments.ren2019.evidence import Cell, Evidence
from owtsweep.verdicts.inference import NOTHING, UNDECIDED, mean_ratio

#: Degrees of freedom of NEES (x, y, v_x and v_y) and of NIS (the two axes of a position fix).
FREEDOM = {"nees": 4.0, "nis": 2.0}
#: An interval that extends beyond this factor is too wide for a verdict on consistency.
WIDEST = 2.0


def judge_consistency(evidence: Evidence) -> pd.DataFrame:
    """Divide NEES and NIS by their degrees of freedom in every cell of the run, and judge them.

    A cell is a combination of conditions in the run's grid. NEES is the normalized estimation error
    squared, NIS the normalized innovation squared.

    Returns
    -------
    DataFrame
        One row per scheme and cell. Columns: scheme, the conditions, for each measure `<measure>`,
        `<measure>_low` and `<measure>_high`, and `verdict`. `<measure>` is the mean over the
        records divided by the degrees of freedom, which is 1 for a consistent filter; the other two
        are the ends of its 95 % interval. All three are NaN where the scheme reports no covariance
        or no innovation. The verdict is one of those that `judge_intervals` returns.
    """
    names = Cell._fields
    levels = [np.unique(evidence.scores.table[name]).tolist() for name in names]
    rows = []
    for scheme, cell in product(evidence.schemes, map(Cell._make, product(*levels))):
        row: dict[str, object] = {"scheme": scheme, **cell._asdict()}
        intervals = []
        for measure, degrees in FREEDOM.items():
            samples = evidence.samples(scheme, cell, measure)
            ratio = NOTHING if samples is None else mean_ratio("", samples, degrees, 1.0, "above")
            row |= {measure: ratio.value}
            row |= {f"{measure}_low": ratio.low, f"{measure}_high": ratio.high}
            intervals.append((ratio.low, ratio.high))
        rows.append(row | {"verdict": judge_intervals(intervals)})
    return pd.DataFrame(rows)


def judge_intervals(intervals: list[tuple[float, float]]) -> str:
    """Return the verdict on a filter's consistency from the 95 % intervals of NEES and NIS.

    Parameters
    ----------
    intervals
        Pairs (low, high), one per measure, of the interval of a quantity that is 1 for a consistent
        filter. Intervals with NaN ends are left out.

    Returns
    -------
    str
        "unknown" if no interval is left; "optimistic" if an interval lies above 1 and none below;
        "pessimistic" if an interval lies below 1 and none above; "mixed" if one interval lies above
        1 and another below; "consistent" if all intervals contain 1 and lie within 1/2 to 2;
        "undecided" if all intervals contain 1 but one of them extends beyond 1/2 or 2.
    """
    finite = [(low, high) for low, high in intervals if np.isfinite(low)]
    above = any(low > 1.0 for low, _ in finite)
    below = any(high < 1.0 for _, high in finite)
    if not finite:
        return "unknown"
    if above and below:
        return "mixed"
    if above or below:
        return "optimistic" if above else "pessimistic"
    tight = all(low >= 1.0 / WIDEST and high <= WIDEST for low, high in finite)
    return "consistent" if tight else UNDECIDED
