"""Judge what Maes et al. (2018) say, F1 to F10, and the study's own goals, on many records.

    python -m experiments.maes2018.fidelity [FOLDER] [RECORDS]

FOLDER (default: results/blade_paper) gets fidelity.md, fidelity.html, scores.csv and
fidelity_claims.csv; RECORDS is 100 by default.
"""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from experiments.command import read_words
from experiments.maes2018.processing import COLUMNS
from experiments.maes2018.scenarios import REFERENCE
from experiments.maes2018.scores import collect
from experiments.report import write_paper
from owtsweep.io.steps import show_steps
from owtsweep.verdicts.page import TextTable
from owtsweep.verdicts.score_table import ScoreTable


def write_report(scores: pd.DataFrame, folder: Path) -> list[Path]:
    """Write fidelity.md, fidelity.html and their tables into a folder; return the files.

    `scores` are as `scores.collect` makes them. The folder is made if it does not exist.
    """
    table, shown = ScoreTable(scores), show_differences(scores)
    return write_paper(__file__, folder, [table], {"scores": scores}, shown, records=table.records)


def show_differences(scores: pd.DataFrame) -> TextTable:
    """Return the mean differences of both systems as a table of texts, in mm and deg."""
    means = scores.groupby(["scenario", "measure"])["value"].mean()
    rows = []
    for name in REFERENCE:
        row = {column: means.get((name, f"difference_{column}")) for column in COLUMNS}
        rows.append([name, *(_show(column, value) for column, value in row.items())])
    return TextTable(["", *COLUMNS], rows, numbers=COLUMNS)


def _show(column: str, value: float | None) -> str:
    if value is None:
        return "–"
    return f"{1e3 * value:.1f}" if "_" in column else f"{value:.3f}"


if __name__ == "__main__":
    target, records, _ = read_words("results/blade_paper", 100)
    with show_steps():
        files = write_report(collect(range(records)), target)
    print(*files, sep="\n")
