"""Judge what Mehammer et al. (2018) say, F1 to F10, and the study's own goals, on many records.

    python -m experiments.mehammer2018.fidelity [FOLDER] [RECORDS]

FOLDER (default: results/floater_paper) gets fidelity.md, fidelity.html, scores.csv, cells.csv (of
the maps), stored_tests.csv, fidelity_claims.csv and the figures; RECORDS is 100 by default.

The command `owtsweep fidelity RUN` is no way to this: a run of the study has one truth and one way
of losses, and the statements compare several on the same records.
"""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from experiments.command import read_words
from experiments.mehammer2018.collecting import MOST, collect, list_lost_cells
from experiments.mehammer2018.figures import FIGURES, draw_figures
from experiments.mehammer2018.published import compare_stored, read_author_record, show_stored
from experiments.mehammer2018.scenarios import OWN
from experiments.report import write_paper
from owtsweep.io.terminal import show_steps
from owtsweep.studies.floater.config import FloaterConfig
from owtsweep.verdicts.page import Bullets, Heading
from owtsweep.verdicts.score_table import ScoreTable


def write_report(
    scores: pd.DataFrame, cells: pd.DataFrame, config: FloaterConfig, folder: Path
) -> list[Path]:
    """Write fidelity.md, fidelity.html and their tables into a folder; return the files.

    Parameters
    ----------
    scores, cells
        As `collecting.collect` makes them.
    config
        The configuration of one scenario, for the page's head.
    folder
        Made if it does not exist.
    """
    stored = compare_stored(scores)
    tables = {"scores": scores, "cells": cells, "stored_tests": stored}
    lost = Bullets(list_lost_cells(cells) or ["In no cell."])
    end = [Heading("Where velocities of a rival are as good"), lost]
    values = {"records": scores["replicate"].nunique(), "most": MOST, "config": config}
    judged, shown = list_tables(scores, cells), show_stored(stored)
    return write_paper(__file__, folder, judged, tables, shown, values, end)


def list_tables(scores: pd.DataFrame, cells: pd.DataFrame) -> list[ScoreTable]:
    """Return the tables by which claims are judged: scenarios, maps, and the author's record."""
    author = read_author_record().assign(replicate=0)
    return [ScoreTable(scores), ScoreTable(cells), ScoreTable(author)]


if __name__ == "__main__":
    target, records, _ = read_words("results/floater_paper", 100)
    with show_steps():
        files = write_report(*collect(range(records)), OWN["20 dB"].compose(), target)
        files += draw_figures(list(FIGURES), target / "figures")
    print(*files, sep="\n")
