"""The numbers and statements that Ren et al. (2019) print, as data.

Numbers are kept as printed, including misprints; a `note` marks a number that must be wrong.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.verdicts.published import read_published

if TYPE_CHECKING:
    import pandas as pd

#: The package whose folder `data/` holds the printed numbers.
PACKAGE = "owtsweep.studies.hub"
#: Measure in Tables 6 to 9 -> its column in the data file.
MEASURES = {"x": "mse_x_m2", "y": "mse_y_m2", "vx": "mse_vx_m2_s2", "vy": "mse_vy_m2_s2"}


def mse_tables() -> pd.DataFrame:
    """Read Tables 6 to 9 of Ren et al. (2019): the MSE of four schemes at four conditions.

    Returns
    -------
    DataFrame
        One row per number, in the order of the print. Columns: table, natural_period (s), amplitude
        (m), scheme, measure (x, y, vx or vy), published (m^2 for x and y, m^2/s^2 for vx and vy),
        note.
    """
    import pandas as pd

    wide = read_published(PACKAGE, "ren2019_tables6to9_mse.csv").rename(
        columns={"natural_period_s": "natural_period", "amplitude_m": "amplitude"}
    )
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


def facts() -> pd.DataFrame:
    """Read what the text of Ren et al. (2019) says about its results.

    Columns: id (F1 to F11), section, quantity, statement.
    """
    return read_published(PACKAGE, "ren2019_facts.csv", text=("section",))
