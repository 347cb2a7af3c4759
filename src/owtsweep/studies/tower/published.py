"""The numbers and statements that Simpson, Chatzi and Chatzis (2025) print, as data.

Numbers are as printed. Statements are in our words, each with the numeric reading by which it is
judged; thresholds are ours, because the paper has none.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.verdicts.published import read_published

if TYPE_CHECKING:
    import pandas as pd

#: The package whose folder `data/` holds what is printed.
PACKAGE = "owtsweep.studies.tower"


def read_table3() -> pd.DataFrame:
    """Read Table 3: TRAC, FRAC and MAE of eight states with three sensor set-ups, 72 numbers.

    Columns: setup (name in conf/studies/tower/sensors), metric (TRAC, FRAC or MAE), state (x0_FA,
    theta15_SS, ...: quantity, metres above the ground, direction), value (MAE of x in m, of theta
    in rad).
    """
    return read_published(PACKAGE, "simpson2025_table3.csv")


def read_facts() -> pd.DataFrame:
    """Read what the text says about results.

    Columns: id (F1 to F14), section, quantity, statement, reading.
    """
    return read_published(PACKAGE, "simpson2025_facts.csv", text=("section",))
