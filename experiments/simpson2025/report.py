"""Write the report on how well the study reproduces Simpson et al. (2025)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from experiments.simpson2025.evidence import Scores
from experiments.simpson2025.goals import GOALS, TEXTS
from experiments.simpson2025.statements import STATEMENTS
from experiments.simpson2025.table_3 import compare_table, show_table
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.verdicts import report, sections
from owtsweep.verdicts.page import Block, Bullets, Heading, Paragraph
from owtsweep.verdicts.statements import JudgedStatement, judge, tabulate_claims

TITLE = "How well the tower study reproduces Simpson et al. (2025)"
#: The origin of the tests.
DEFINITIONS = (
    "Thresholds were written down before any record was judged; numbers of earlier prototypes were "
    "known. After a look at the first records, means of ratios took the place of ratios of means "
    "(F3, F4, F7, F8, F12, G7, G8), F13 the inverse factor, F7 its part without gravity, and G8 "
    "the count of unseen directions in place of the drift without a receiver."
)


def read_facts() -> pd.DataFrame:
    """Read what the text says about results.

    Columns: id (F1 to F14), section, quantity, statement, reading.
    """
    return pd.read_csv(Path(__file__).with_name("facts.csv"), dtype={"section": str})


def judge_statements(scores: Scores) -> list[JudgedStatement]:
    """Judge the statements F1 to F14 of Simpson et al. (2025)."""
    facts = read_facts()
    texts = dict(zip(facts["id"], facts["statement"], strict=True))
    return judge(texts, STATEMENTS, scores)


def judge_goals(scores: Scores) -> list[JudgedStatement]:
    """Judge the project's own goals G1 to G9."""
    return judge(TEXTS, GOALS, scores)


def write_report(scores: Scores, config: TowerConfig, folder: Path) -> list[Path]:
    """Write fidelity.md, fidelity.html and their tables into a folder; return the files.

    Parameters
    ----------
    scores
        Of all scenarios in `scenarios.ALL`.
    config
        The configuration of one of them, for the page's head.
    folder
        Made if it does not exist.
    """
    statements, goals = judge_statements(scores), judge_goals(scores)
    table = compare_table(scores)
    return report.write_report(
        folder,
        title=TITLE,
        tables={
            "scores": scores.table,
            "table_3": table,
            "fidelity_claims": tabulate_claims([*statements, *goals]),
        },
        figures={},
        contents=lambda _: _document(scores, config, statements, goals, table),
        metadata={"study": "tower", "paper": "Simpson et al. (2025)"},
    )


def _document(
    scores: Scores,
    config: TowerConfig,
    statements: Sequence[JudgedStatement],
    goals: Sequence[JudgedStatement],
    table: pd.DataFrame,
) -> list[Block]:
    record = config.record
    return [
        Heading(TITLE, 1),
        Paragraph(
            f"{scores.records} records of {record.duration:g} s at {record.rate:g} Hz, seed "
            f"{config.seed}, judged after {record.settling:g} s; noise 1 % of each signal's "
            "standard deviation; tuning paper unless said otherwise; damage with the printed S-N "
            "curve (m = 5, log a = 13.617, Goodman with 500 MPa). The truth is a linear beam with "
            "soil, rotor-nacelle and rotor loads of declared statistics, not the paper's Simulink "
            "turbine: absolute numbers (MAE, damage, inputs) cannot agree, ratios and statements "
            "can. Displacements drift without displacement sensors, because inclinometers and "
            "accelerometers do not see position and velocity of the rigid translation: that is "
            "observability, not tuning. Brackets are 95 % intervals of means over the records. "
            "Directions: fa fore-aft, ss side-side."
        ),
        Heading("In short"),
        Bullets(
            [
                f"Statements F1-F14: {sections.count_verdicts(statements)}.",
                f"Goals G1-G9: {sections.count_verdicts(goals)}.",
            ]
        ),
        *sections.statement_section(statements, DEFINITIONS),
        Heading("Table 3"),
        Paragraph(
            "Printed number / mean over the records, wind only. MAE in m and rad. The drift of "
            "displacements without displacement sensors is that of an unobservable motion: its "
            "size depends on tuning and seed, and has no other meaning."
        ),
        show_table(table),
        *sections.goal_section(goals),
    ]
