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
from experiments.mehammer2018.cells import list_lost_cells
from experiments.mehammer2018.collecting import MOST, collect
from experiments.mehammer2018.figures import FIGURES, draw_figures
from experiments.mehammer2018.published import compare_stored, read_author_record, show_stored
from experiments.mehammer2018.scenarios import OWN
from owtsweep.io.steps import show_steps
from owtsweep.studies.floater.config import FloaterConfig
from owtsweep.verdicts.claims_file import read_claims
from owtsweep.verdicts.page import Bullets, Heading, Paragraph
from owtsweep.verdicts.report import write_verdicts
from owtsweep.verdicts.score_table import ScoreTable

CLAIMS = Path(__file__).with_name("claims.toml")


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
    record, stored = config.record, compare_stored(scores)
    return write_verdicts(
        folder,
        read_claims(CLAIMS),
        list_tables(scores, cells),
        title="How well the floater study reproduces Mehammer et al. (2018)",
        about=(
            f"{scores['replicate'].nunique()} records (of the paper's tests at most {MOST}) of "
            f"{record.duration:g} s at {record.rate:g} Hz, seed {config.seed}, judged after "
            f"{record.settling:g} s; the decay 120 s at 200 Hz, judged after 2 s. The truth "
            "is a motion of declared spectra, and a decay of declared periods, not the author's "
            "SIMA record and buoy: absolute numbers cannot agree, ratios and statements can. "
            "Numbers of the author's record are marked so: it is public (the paper's reference "
            "[12]), has no licence, and is not kept here; experiments/mehammer2018/"
            "author_record.py makes them. Brackets are 95 % intervals of means over the records."
        ),
        metadata={"study": "floater", "paper": "Mehammer et al. (2018)"},
        tables={"scores": scores, "cells": cells, "stored_tests": stored},
        middle=[
            Heading("Rms errors in the author's files"),
            Paragraph(
                "Author's number, on SIMA's record / mean over the records here, m. SIMA's record "
                "is not kept here, so the motions differ. z of test 10 is what the author's delay "
                "buffer is padded with."
            ),
            show_stored(stored),
        ],
        end=[
            Heading("Where velocities of a rival are as good"),
            Bullets(list_lost_cells(cells) or ["In no cell."]),
        ],
    )


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
