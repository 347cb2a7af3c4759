"""Tables 6-9 of Ren et al. (2019): the MSE of every scheme beside the published numbers.

    python -m experiments.ren2019.tables_6_to_9 [RUN]

RUN is the folder of a run. Without RUN, the default study is used; it is run first if needed. The
tables are written into its folder figures/, as tables_6_to_9.csv and tables_6_to_9.md.
"""

from __future__ import annotations

from typing import Any

import pandas as pd

from experiments.command import open_run
from experiments.ren2019.published import mse_tables
from experiments.ren2019.sections import NO_VALUE, format_ratio
from owtsweep.io import markdown
from owtsweep.io.files import write_atomically
from owtsweep.io.tables import write_table
from owtsweep.studies.hub.describe import describe_in_a_line
from owtsweep.verdicts.score_table import DIGITS

COLUMNS = (
    "table", "natural_period", "amplitude", "scheme", "measure", "published", "reproduced",
    "ci_low", "ci_high", "ratio", "note",
)  # fmt: skip
CONDITIONS = ["natural_period", "amplitude"]
MISSING = "not in this run"
UNITS = {"x": "m²", "y": "m²", "vx": "m²/s²", "vy": "m²/s²"}


def tables_6_to_9(summary: pd.DataFrame, *, window: str) -> pd.DataFrame:
    """Put the 64 numbers of tables 6-9 of Ren et al. (2019) beside those of a run.

    Parameters
    ----------
    summary
        The table summary.csv of a run.
    window
        The time window of the run's numbers, "full" or "settled".

    Returns
    -------
    DataFrame
        One row per published number; the columns are `COLUMNS`. `published` and `reproduced` are
        mean square errors, of x and y in m^2, of vx and vy in m^2/s^2. `ci_low` and `ci_high` are
        the ends of the 95 % interval of the reproduced mean. `ratio` is reproduced / published.
        Where the run lacks the scheme or the conditions, the run's values are NaN and the note says
        "not in this run".
    """
    keys = [*CONDITIONS, "scheme", "measure"]
    run = summary.loc[summary["window"] == window, [*keys, "mean", "ci_low", "ci_high"]]
    run = run.rename(columns={"mean": "reproduced"})
    run[CONDITIONS] = run[CONDITIONS].astype(float).round(DIGITS)
    table = mse_tables().merge(run, on=keys, how="left", validate="one_to_one")

    table["ratio"] = table["reproduced"] / table["published"]
    missing = table["reproduced"].isna()
    separator = table["note"].map(lambda note: "; " if note else "")
    table["note"] = table["note"].where(~missing, table["note"] + separator + MISSING)
    return table[list(COLUMNS)]


def to_markdown(table: pd.DataFrame) -> str:
    """Write the result of `tables_6_to_9` as Markdown, one table per natural period and amplitude.

    Each table has one line per scheme. A cell reads "published → reproduced (ratio)". If the run
    lacks the number, a dash stands for the reproduced number.
    """
    parts = []
    shown = table.assign(cell=[_cell(row) for row in table.to_dict("records")])
    for (number, period, amplitude), rows in shown.groupby(["table", *CONDITIONS], sort=True):
        header = [f"{measure} ({UNITS[measure]})" for measure in dict.fromkeys(rows["measure"])]
        cells = [[scheme, *texts] for scheme, texts in rows.groupby("scheme", sort=False)["cell"]]
        lines = [
            f"### Table {number}: natural period {period:g} s, amplitude {amplitude:g} m",
            "",
            "MSE, published → this run (ratio this run / published)"
            + (f"; {NO_VALUE}: {MISSING}" if rows["reproduced"].isna().any() else ""),
            "",
            markdown.table(["scheme", *header], cells, numbers=header),
        ]
        notes = [
            f"{row['scheme']} {row['measure']}: {row['note']}."
            for row in rows.to_dict("records")
            if row["note"] not in ("", MISSING)
        ]
        parts.append("\n".join([*lines, *(["", *notes] if notes else [])]))
    return "\n\n".join(parts) + "\n"


def _cell(row: dict[Any, Any]) -> str:
    if row["reproduced"] != row["reproduced"]:
        return f"{_number(row['published'])} → {NO_VALUE}"
    ratio = format_ratio(row["ratio"])
    return f"{_number(row['published'])} → {_number(row['reproduced'])} ({ratio})"


def _number(value: float) -> str:
    """Format a number with three significant digits and a short exponent, e.g. 1.42e-3."""
    mantissa, exponent = f"{value:.2e}".split("e")
    return f"{mantissa}e{int(exponent)}"


if __name__ == "__main__":
    run = open_run()
    for tuning, part in run.by_tuning().items():
        table = tables_6_to_9(part.summary(), window=part.config.measures.window)
        folder, name = run.place / "figures", f"tables_6_to_9{f'_{tuning}' if tuning else ''}"
        print(write_table(folder, name, table))
        origin, text = f"{describe_in_a_line(part.config)}.", folder / f"{name}.md"
        write_atomically(text, f"{origin}\n\n{to_markdown(table)}")
        print(text)
