"""Judge what Maes et al. (2018) say, F1 to F10, and the study's own goals, on many records.

    python -m experiments.maes2018.fidelity [FOLDER] [RECORDS]

FOLDER (default: results/blade_paper) gets fidelity.md, fidelity.html, scores.csv, printed.csv and
fidelity_claims.csv; RECORDS is 100 by default.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from experiments.command import read_words
from experiments.maes2018.processing import COLUMNS, ROTATIONS
from experiments.maes2018.scenarios import REFERENCE
from experiments.maes2018.scores import collect
from experiments.report import write_paper
from experiments.single_record import place_print, show_chance
from owtsweep.io.terminal import show_steps
from owtsweep.verdicts.page import TextTable
from owtsweep.verdicts.score_table import ScoreTable

#: What is printed of the differences of both systems, as it is rounded: of translations 10 to 21
#: mm, of rotations .070 to .115 deg (figures 11 and 12), in m and deg.
TRANSLATIONS_DIFFER, ROTATIONS_DIFFER = (0.0095, 0.0215), (0.0695, 0.1155)
#: Measure of the smoothed root -> its printed rms error, 1 mm horizontally, 2 mm vertically, as it
#: is rounded (section 2.1), m.
ERRORS = {"root_x": (0.0005, 0.0015), "root_y": (0.0005, 0.0015), "root_z": (0.0015, 0.0025)}


def write_report(scores: pd.DataFrame, folder: Path) -> list[Path]:
    """Write fidelity.md, fidelity.html and their tables into a folder; return the files.

    `scores` are as `scores.collect` makes them. The folder is made if it does not exist.
    """
    table, printed = ScoreTable(scores), compare_printed(scores)
    tables, values = {"scores": scores, "printed": printed}, {"records": table.records}
    return write_paper(__file__, folder, [table], tables, show_differences(printed), values)


def compare_printed(scores: pd.DataFrame) -> pd.DataFrame:
    """Return the printed rms differences and errors with those of our records.

    Columns: scenario, measure, least and greatest (what is printed), mean over the records, in m
    and deg, and chance and agrees: whether one record could have printed a number in that range
    (`single_record`).
    """
    smoothed = scores[scores["scheme"] == "SMOOTHER"]
    groups = smoothed.groupby(["scenario", "measure"])["value"]
    values = {key: group.to_numpy() for key, group in groups}
    printed = {
        (name, f"difference_{column}"): (
            ROTATIONS_DIFFER if column in ROTATIONS else TRANSLATIONS_DIFFER
        )
        for name in REFERENCE
        for column in COLUMNS
    } | {("filters", measure): ends for measure, ends in ERRORS.items()}
    rows = []
    for key, ends in printed.items():
        found = values.get(key, np.array([np.nan]))
        place = place_print(*ends, found)
        rows.append((*key, *ends, found.mean(), place.chance, place.agrees))
    columns = ["scenario", "measure", "least", "greatest", "mean", "chance", "agrees"]
    return pd.DataFrame(rows, columns=columns)


def show_differences(printed: pd.DataFrame) -> TextTable:
    """Return the mean differences of both systems as a table: "mean (chance)", in mm and deg."""
    found = printed.set_index(["scenario", "measure"])
    rows = []
    for name in REFERENCE:
        cells = [_show(column, found.loc[(name, f"difference_{column}")]) for column in COLUMNS]
        rows.append([name, *cells])
    return TextTable(["", *COLUMNS], rows, numbers=COLUMNS)


def _show(column: str, row: pd.Series) -> str:
    mean = f"{1e3 * row['mean']:.1f}" if "_" in column else f"{row['mean']:.3f}"
    return f"{mean} ({show_chance(row['chance'])})"


if __name__ == "__main__":
    target, records, _ = read_words("results/blade_paper", 100)
    with show_steps():
        files = write_report(collect(range(records)), target)
    print(*files, sep="\n")
