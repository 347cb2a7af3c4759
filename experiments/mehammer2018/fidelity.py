"""Judge what Mehammer et al. (2018) say, F1 to F10, and the study's own goals, on many records.

    python -m experiments.mehammer2018.fidelity [FOLDER] [RECORDS]

FOLDER (default: results/floater_paper) gets fidelity.md, fidelity.html, scores.csv,
stored_tests.csv, fidelity_claims.csv and the figures; RECORDS is 100 by default.

The command `owtsweep fidelity RUN` is no way to this: a run of the study has one truth and one way
of losses, and the statements compare several on the same records.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from experiments.mehammer2018.collecting import MOST, OWN, collect
from experiments.mehammer2018.figures import FIGURES, draw_figures
from experiments.mehammer2018.goals import GOALS, TEXTS, list_lost_cells
from experiments.mehammer2018.published import read_facts
from experiments.mehammer2018.statements import STATEMENTS
from experiments.mehammer2018.stored import compare_stored, show_stored
from owtsweep.io.steps import show_steps
from owtsweep.studies.floater.config import FloaterConfig
from owtsweep.verdicts import report, sections
from owtsweep.verdicts.page import Block, Bullets, Heading, Paragraph
from owtsweep.verdicts.scores import Scores
from owtsweep.verdicts.statements import JudgedStatement, judge, tabulate_claims

if TYPE_CHECKING:
    import pandas as pd

TITLE = "How well the floater study reproduces Mehammer et al. (2018)"
#: The origin of the tests.
DEFINITIONS = (
    "Thresholds are the paper's, or were written down before any record was judged; numbers of "
    "earlier prototypes and of the author's files were known."
)


def judge_statements(scores: Scores) -> list[JudgedStatement]:
    """Judge the statements F1 to F10 of Mehammer et al. (2018)."""
    facts = read_facts()
    texts = dict(zip(facts["id"], facts["statement"], strict=True))
    return judge(texts, STATEMENTS, scores)


def judge_goals(scores: Scores) -> list[JudgedStatement]:
    """Judge the project's own goals."""
    return judge(TEXTS, GOALS, scores)


def write_report(scores: Scores, config: FloaterConfig, folder: Path) -> list[Path]:
    """Write fidelity.md, fidelity.html and their tables into a folder; return the files.

    Parameters
    ----------
    scores
        As `collecting.collect` makes them.
    config
        The configuration of one scenario, for the page's head.
    folder
        Made if it does not exist.
    """
    statements, goals = judge_statements(scores), judge_goals(scores)
    table = compare_stored(scores)
    return report.write_report(
        folder,
        title=TITLE,
        tables={
            "scores": scores.table,
            "stored_tests": table,
            "fidelity_claims": tabulate_claims([*statements, *goals]),
        },
        figures={},
        contents=lambda _: _document(scores, config, statements, goals, table),
        metadata={"study": "floater", "paper": "Mehammer et al. (2018)"},
    )


def _document(
    scores: Scores,
    config: FloaterConfig,
    statements: Sequence[JudgedStatement],
    goals: Sequence[JudgedStatement],
    table: pd.DataFrame,
) -> list[Block]:
    record = config.record
    return [
        Heading(TITLE, 1),
        Paragraph(
            f"{scores.records} records (of the paper's tests at most {MOST}) of "
            f"{record.duration:g} s at {record.rate:g} Hz, seed {config.seed}, judged after "
            f"{record.settling:g} s; the decay 120 s at 200 Hz, judged after 2 s. The truth "
            "is a motion of declared spectra, and a decay of declared periods, not the author's "
            "SIMA record and buoy: absolute numbers cannot agree, ratios and statements can. "
            "Numbers of the author's record are marked so: it is public (the paper's reference "
            "[12]), has no licence, and is not kept here; experiments/mehammer2018/"
            "author_record.py makes them. Brackets are 95 % intervals of means over the records."
        ),
        Heading("In short"),
        Bullets(
            [
                f"Statements F1-F10: {sections.count_verdicts(statements)}.",
                f"Goals G1-G{len(goals)}: {sections.count_verdicts(goals)}.",
            ]
        ),
        *sections.statement_section(statements, DEFINITIONS),
        Heading("Rms errors in the author's files"),
        Paragraph(
            "Author's number, on SIMA's record / mean over the records here, m. SIMA's record is "
            "not kept here, so the motions differ. z of test 10 is what the author's delay buffer "
            "is padded with."
        ),
        show_stored(table),
        *sections.goal_section(goals),
        Heading("Where velocities of a rival are as good"),
        Bullets(list_lost_cells(scores) or ["In no cell."]),
    ]


if __name__ == "__main__":
    target = Path(sys.argv[1] if len(sys.argv) > 1 else "results/floater_paper")
    records = int(sys.argv[2]) if len(sys.argv) > 2 else 100
    with show_steps():
        found = Scores(collect(range(records)))
        files = write_report(found, OWN["20 dB"].compose(), target)
        files += draw_figures(list(FIGURES), target / "figures")
    for file in files:
        print(file)
