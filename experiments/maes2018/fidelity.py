"""Judge what Maes et al. (2018) say, F1 to F10, and the study's own goals, on many records.

    python -m experiments.maes2018.fidelity [FOLDER] [RECORDS]

FOLDER (default: results/blade_paper) gets fidelity.md, fidelity.html, scores.csv and
fidelity_claims.csv; RECORDS is 100 by default.
"""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from experiments.command import read_words
from experiments.maes2018.collecting import collect
from experiments.maes2018.processing import COLUMNS
from experiments.maes2018.scenarios import REFERENCE
from owtsweep.io.steps import show_steps
from owtsweep.verdicts.claims_file import read_claims
from owtsweep.verdicts.page import Heading, Paragraph, TextTable
from owtsweep.verdicts.report import write_verdicts
from owtsweep.verdicts.score_table import ScoreTable

CLAIMS = Path(__file__).with_name("claims.toml")


def write_report(scores: pd.DataFrame, folder: Path) -> list[Path]:
    """Write fidelity.md, fidelity.html and their tables into a folder; return the files.

    `scores` are as `collecting.collect` makes them. The folder is made if it does not exist.
    """
    table = ScoreTable(scores)
    return write_verdicts(
        folder,
        read_claims(CLAIMS),
        [table],
        title="How well the blade study reproduces Maes et al. (2018)",
        about=(
            f"{table.records} records of 300 s at 50 Hz, seed 2018, judged after 60 s. The truth "
            "is a rigid blade with declared periods and sizes, not the paper's lift, of which only "
            "pictures are printed. Brackets are 95 % intervals of means over the records."
        ),
        metadata={"study": "blade", "paper": "Maes et al. (2018)"},
        tables={"scores": scores},
        middle=[
            Heading("What the printed differences require"),
            Paragraph(
                "Rms difference of the smoothed inertial system and the total stations, mm and "
                "deg; printed: 10 to 21 mm, .070 to .115 deg. The late clock is .1 s late; the "
                "bent blade has its outer prisms 5 cm farther apart than believed, along the "
                "blade. The sagging blade hangs 3 cm below the rigid one at its third prism; this "
                "size was chosen afterwards, to be near the printed rotations, so its rows test "
                "nothing."
            ),
            show_differences(scores),
        ],
    )


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
