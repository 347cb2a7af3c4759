"""Table 3 of Simpson et al. (2025) beside what the study finds: 72 numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from owtsweep.studies.tower.paper.evidence import Scores
from owtsweep.studies.tower.paper.judging import WIND
from owtsweep.verdicts.page import TextTable
from owtsweep.verdicts.published import read_published

if TYPE_CHECKING:
    import pandas as pd

#: The package whose folder `data/` holds the printed numbers.
PACKAGE = "owtsweep.studies.tower"


def compare_table(scores: Scores) -> pd.DataFrame:
    """Return Table 3 with the study's numbers.

    Returns
    -------
    DataFrame
        One row per printed number. Columns: sensors, metric, state (e.g. "x0"), direction,
        published, mean, least and greatest over the records, and relative: the mean over the true
        signal's standard deviation, for MAE.
    """
    import pandas as pd

    wide = read_published(PACKAGE, "simpson2025_table3.csv")
    rows = []
    for _, printed in wide.iterrows():
        for column in wide.columns[2:]:
            state, direction = column.rsplit("_", 1)
            metric = str(printed["metric"])
            scenario = WIND[str(printed["sensors"])]
            found = scores.find(scenario, direction, state, metric.lower())
            relative = scores.find(scenario, direction, state, "relative_mae")
            none = np.array([np.nan])
            values = none if found is None else found
            ratio = none if relative is None or metric != "MAE" else relative
            rows.append(
                {
                    "sensors": printed["sensors"], "metric": metric, "state": state,
                    "direction": direction, "published": float(printed[column]),
                    "mean": values.mean(), "least": values.min(), "greatest": values.max(),
                    "relative": ratio.mean(),
                }
            )  # fmt: skip
    return pd.DataFrame(rows)


def show_table(table: pd.DataFrame) -> TextTable:
    """Return the comparison as a table of texts, laid out as the print: "published | mean"."""
    states = list(dict.fromkeys(zip(table["state"], table["direction"], strict=True)))
    columns = [f"{state} {direction}" for state, direction in states]
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
        return f"{published:.0e} / {mean:.0e}" if published < 0.01 else f"{published:g} / {mean:.3g}"
    return f"{published:.3f} / {mean:.4f}"
