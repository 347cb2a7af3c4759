"""Table 3 of Simpson et al. (2025) beside the study's numbers: 72 of each."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from experiments.single_record import place_print, read_rounded, show_chance
from owtsweep.verdicts.page import TextTable


def read_printed() -> pd.DataFrame:
    """Read what is printed: TRAC, FRAC and MAE of eight states with three sensor set-ups.

    Columns: setup (name in conf/studies/tower/sensors), metric (TRAC, FRAC or MAE), state (x0_FA,
    theta15_SS, ...: quantity, metres above the ground, direction), value (MAE of x in m, of theta
    in rad).
    """
    printed = read_texts()
    return printed.assign(value=printed["value"].astype(float))


def read_texts() -> pd.DataFrame:
    """Read what is printed, as `read_printed` does, with values as they are written."""
    return pd.read_csv(Path(__file__).with_suffix(".csv"), dtype={"value": str})


def compare_table(scores: pd.DataFrame) -> pd.DataFrame:
    """Return Table 3 with the numbers of scores, as `scores.tabulate` returns them.

    Returns
    -------
    DataFrame
        One row per printed number. Columns: sensors, metric, state (e.g. "x0_FA"), published,
        mean, least and greatest over the records, relative: the mean over the true signal's
        standard deviation, for MAE, and chance and agrees: whether one record could have printed
        the number (`single_record`), by its error, which is 1 - value of TRAC and FRAC.
    """
    of_table = {"sea": "calm", "gravity": True, "weight": False, "scheme": "AKF", "tuning": "paper"}
    chosen = scores[(scores[list(of_table)] == pd.Series(of_table)).all(axis=1)]
    groups = chosen.groupby(["sensors", "direction", "quantity", "measure"])["value"]
    values = {key: group.to_numpy() for key, group in groups}
    nothing = np.array([np.nan])
    rows = []
    printed: Any = read_texts().itertuples(index=False)
    for setup, metric, state, text in printed:
        quantity, direction = state.lower().split("_")
        found = values.get((setup, direction, quantity, metric.lower()), nothing)
        relative = values.get((setup, direction, quantity, "relative_mae"), nothing)
        least, greatest = read_rounded(text)
        if metric == "MAE":
            place = place_print(least, greatest, found)
        else:
            place = place_print(1.0 - greatest, 1.0 - least, 1.0 - found)
        rows.append(
            {
                "sensors": setup, "metric": metric, "state": state, "published": float(text),
                "mean": found.mean(), "least": found.min(), "greatest": found.max(),
                "relative": relative.mean() if metric == "MAE" else np.nan,
                "chance": place.chance, "agrees": place.agrees,
            }
        )  # fmt: skip
    return pd.DataFrame(rows)


def show_table(table: pd.DataFrame) -> TextTable:
    """Return the comparison laid out as the print, in texts: "published / mean (chance)"."""
    columns = list(dict.fromkeys(table["state"]))
    rows = []
    for (sensors, metric), part in table.groupby(["sensors", "metric"], sort=False):
        cells = [
            f"{_format(str(metric), published, mean)} ({show_chance(chance)})"
            for published, mean, chance in zip(
                part["published"], part["mean"], part["chance"], strict=True
            )
        ]
        rows.append([str(sensors), str(metric), *cells])
    return TextTable(["set-up", "metric", *columns], rows, columns)


def _format(metric: str, published: float, mean: float) -> str:
    if metric == "MAE":
        return (
            f"{published:.0e} / {mean:.0e}" if published < 0.01 else f"{published:g} / {mean:.3g}"
        )
    return f"{published:.3f} / {mean:.4f}"
