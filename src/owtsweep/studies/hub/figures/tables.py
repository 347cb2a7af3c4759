"""Tables 6-9 of Ren et al. (2019): the published numbers beside those of a run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from owtsweep.io import markdown
from owtsweep.studies.hub import published

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = (
    "table", "natural_period", "amplitude", "scheme", "measure", "published", "reproduced",
    "ci_low", "ci_high", "ratio", "note",
)  # fmt: skip
MISSING = "not in this run"
NO_VALUE = "–"
UNITS = {"x": "m²", "y": "m²", "vx": "m²/s²", "vy": "m²/s²"}
#: A condition of the run is one of the paper's if they agree to this many decimal places.
DIGITS = 9


def tables_6_to_9(summary: pd.DataFrame, *, window: str) -> pd.DataFrame:
    """The 64 published numbers beside those of the run.

    Parameters
    ----------
    summary
        Columns of summary.csv.
    window
        "full" or "settled".

    Returns
    -------
    DataFrame
        `COLUMNS`: MSE of x and y in m^2, of vx and vy in m^2/s^2, with the 95 % interval of the
        reproduced mean; ratio = reproduced / published. Conditions that the run lacks have NaN and
        the note "not in this run".
    """
    conditions = ["natural_period", "amplitude"]
    keys = [*conditions, "scheme", "measure"]
    run = summary.loc[summary["window"] == window, [*keys, "mean", "ci_low", "ci_high"]]
    run = run.rename(columns={"mean": "reproduced"})
    run[conditions] = run[conditions].astype(float).round(DIGITS)
    table = published.mse_tables().merge(run, on=keys, how="left", validate="one_to_one")

    table["ratio"] = table["reproduced"] / table["published"]
    missing = table["reproduced"].isna()
    separator = table["note"].map(lambda note: "; " if note else "")
    table["note"] = table["note"].where(~missing, table["note"] + separator + MISSING)
    return table[list(COLUMNS)]


def to_markdown(table: pd.DataFrame) -> str:
    """The result of `tables_6_to_9` as Markdown: one table per condition, one line per scheme.

    Each cell reads "published → reproduced (ratio)".
    """
    parts = []
    for (number, period, amplitude), rows in table.groupby(
        ["table", "natural_period", "amplitude"], sort=True
    ):
        measures = list(dict.fromkeys(rows["measure"]))
        header = [f"{measure} ({UNITS[measure]})" for measure in measures]
        lines = [
            f"### Table {number}: natural period {period:g} s, amplitude {amplitude:g} m",
            "",
            "MSE, published → this run (ratio this run / published)"
            + (f"; {NO_VALUE}: {MISSING}" if rows["reproduced"].isna().any() else ""),
            "",
            markdown.table(["scheme", *header], list(_by_scheme(rows, measures)), numbers=header),
        ]
        notes = [
            f"{row['scheme']} {row['measure']}: {row['note']}."
            for row in rows.to_dict("records")
            if row["note"] not in ("", MISSING)
        ]
        parts.append("\n".join([*lines, *(["", *notes] if notes else [])]))
    return "\n\n".join(parts) + "\n"


def _by_scheme(rows: pd.DataFrame, measures: Sequence[str]) -> Iterator[list[str]]:
    for scheme in dict.fromkeys(rows["scheme"]):
        cells = rows[rows["scheme"] == scheme].set_index("measure").to_dict("index")
        yield [scheme, *(_cell(cells[measure]) for measure in measures)]


def _cell(row: dict[str, Any]) -> str:
    if row["reproduced"] != row["reproduced"]:
        return f"{_number(row['published'])} → {NO_VALUE}"
    return f"{_number(row['published'])} → {_number(row['reproduced'])} ({row['ratio']:.2f})"


def _number(value: float) -> str:
    """Three digits, with the exponent as in the paper: 1.42e-3."""
    mantissa, exponent = f"{value:.2e}".split("e")
    return f"{mantissa}e{int(exponent)}"
