"""The printed numbers of Ren et al. (2019): tables 6 to 9, and the boundaries of section 5.3.

Numbers are kept as printed, including a misprint, which a `note` marks.
"""

from __future__ import annotations

from pathlib import Path

import pandas as pd

#: Measure in Tables 6 to 9 -> its column in the data file.
MEASURES = {"x": "mse_x_m2", "y": "mse_y_m2", "vx": "mse_vx_m2_s2", "vy": "mse_vy_m2_s2"}
#: Boundaries of section 5.3: natural period (s) -> amplitude (m) below which HME2 is better than
#: HME1, and above which HME1 is.
BOUNDARIES = {4.0: 0.3, 6.0: 1.0}


def mse_tables() -> pd.DataFrame:
    """Read Tables 6 to 9 of Ren et al. (2019): the MSE of four schemes at four conditions.

    One row per number, in the order of the print. Columns: table, natural_period (s), amplitude
    (m), scheme, measure (x, y, vx or vy), published (m^2 for x and y, m^2/s^2 for vx and vy), note.
    """
    wide = pd.read_csv(Path(__file__).with_name("ren2019_tables6to9_mse.csv"))
    wide["note"] = wide["note"].fillna("").astype(str)
    wide = wide.rename(columns={"natural_period_s": "natural_period", "amplitude_m": "amplitude"})
    keys = ["table", "natural_period", "amplitude", "scheme"]
    parts = []
    for measure, column in MEASURES.items():
        # a note in the data file starts with the name of the column that it is about
        concerns = wide["note"].str.startswith(f"mse_{measure} ")
        note = wide["note"].where(concerns, "").str.removeprefix("mse_")
        part = wide[keys].assign(measure=measure, published=wide[column], note=note)
        parts.append(part)
    tidy = pd.concat(parts).sort_index(kind="stable").reset_index(drop=True)
    return tidy.astype({"natural_period": float, "amplitude": float})


def published_numbers() -> pd.DataFrame:
    """Return the 64 numbers of tables 6-9 of Ren et al. (2019), with Table 7's misprint corrected.

    Columns are those of `mse_tables` and, after `published`, `printed`, which holds the misprint.
    """
    table = mse_tables()
    table.insert(list(table).index("note"), "printed", table["published"])
    misprint = (table.table == 7) & (table.scheme == "EKF") & (table.measure == "vx")
    table.loc[misprint, "published"] = 1.98e-3
    return table
