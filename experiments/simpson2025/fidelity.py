"""Judge what Simpson et al. (2025) say, F1 to F14, and the study's own goals, on several records.

    python -m experiments.simpson2025.fidelity [FOLDER] [RECORDS]

FOLDER (default: results/tower_paper) gets fidelity.md, fidelity.html, scores.csv, table_3.csv,
fidelity_claims.csv and the figures; RECORDS is 10 by default (about a minute each).

The command `owtsweep fidelity RUN` is no way to this: a run of the study has one sensor set-up, one
sea and one gravity, and the statements compare several on the same records.
"""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from experiments.command import read_words
from experiments.report import write_paper
from experiments.simpson2025.figures import FIGURES, draw_figures
from experiments.simpson2025.scenarios import Scenario
from experiments.simpson2025.scores import collect
from experiments.simpson2025.table_3 import compare_table, show_table
from owtsweep.io.terminal import show_steps
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.verdicts.score_table import ScoreTable


def write_report(scores: pd.DataFrame, config: TowerConfig, folder: Path) -> list[Path]:
    """Write fidelity.md, fidelity.html and their tables into a folder; return the files.

    Parameters
    ----------
    scores
        As `scores.collect` returns them.
    config
        The configuration of one scenario, for the page's head.
    folder
        Made if it does not exist.
    """
    table = compare_table(scores)
    tables = {"scores": scores, "table_3": table}
    values = {"records": scores["replicate"].nunique(), "config": config}
    return write_paper(__file__, folder, [ScoreTable(scores)], tables, show_table(table), values)


if __name__ == "__main__":
    folder, records, _ = read_words("results/tower_paper", 10)
    with show_steps():
        files = write_report(collect(range(records)), Scenario().compose(), folder)
        files += draw_figures(list(FIGURES), folder / "figures")
    print(*files, sep="\n")
