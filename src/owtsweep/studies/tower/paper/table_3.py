"""Table 3 of Simpson et al. (2025) beside what the study finds: 72 numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.studies.tower.paper.evidence import Scores
from owtsweep.studies.tower.paper.judging import WIND
from owtsweep.studies.tower.published import read_table3
from owtsweep.verdicts.page import TextTable

if TYPE_CHECKING:
    import pandas as pd


def compare_table(scores: Scores) -> pd.DataFrame:
    """Return Table 3 with the study's numbers.

    Returns
    -------
    DataFrame
        One row per printed number. Columns: sensors, metric, state (e.g. "x0_FA"), published,
        mean, least and greatest over the records, and relative: the mean over the true
        signal's standard deviation, for MAE.
    """
    import pandas as pd

    rows = []
    printed: Any = read_table3().itertuples(index=False)
    for setup, metric, state, value in printed:
        quantity, direction = state.lower().split("_")
        found = scores.find(WIND[setup], direction, quantity, metric.lower())
        relative = scores.find(WIND[setup], direction, quantity, "relative_mae")
        values = np.array([np.nan]) if found is None else found
        ratio = np.array([np.nan]) if relative is None or metric != "MAE" else relative
        rows.append(
            {
                "sensors": setup, "metric": metric, "state": state, "published": value,
                "mean": values.mean(), "least": values.min(), "greatest": values.max(),
                "relative": ratio.mean(),
            }
        )  # fmt: skip
    return pd.DataFrame(rows)


def show_table(table: pd.DataFrame) -> TextTable:
    """Return the comparison as a table of texts, laid out as the print: "published | mean"."""
    columns = list(dict.fromkeys(table["state"]))
    rows = []
    for (sensors, metric), part in table.groupby(["sensors", "metric"], sort=False):
        cells = [
            _format(str(metric), published, mean)
            for published, mean in zip(part["published"], part["mean"], strict=True)
        ]
        rows.append([str(sensors), str(metric), *cells])
    return TextTable(["set-up", "metric", *columns], rows, columns)


def _format(metric: str, published: float, mean: float) -> str:
    if metric == "MAE":
        return (
            f"{published:.0e} / {mean:.0e}" if published < 0.01 else f"{published:g} / {mean:.3g}"
        )
    return f"{published:.3f} / {mean:.4f}"
