"""Write the files of a report on published results: tables, Markdown and HTML pages.

Some sections of the page are the same for every study.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import pandas as pd

from owtsweep.io.files import write_all
from owtsweep.io.tables import write_table
from owtsweep.verdicts.claims_file import ClaimsFile
from owtsweep.verdicts.inference import (
    MISSING,
    NOT_REPRODUCED,
    REPRODUCED,
    UNDECIDED,
    JudgedStatement,
    explain,
    tabulate_claims,
)
from owtsweep.verdicts.judge import judge
from owtsweep.verdicts.page import (
    Block,
    Bullets,
    Heading,
    Paragraph,
    TextTable,
    to_html,
    to_markdown,
)
from owtsweep.verdicts.score_table import ScoreTable


def write_page(folder: Path, title: str, blocks: Sequence[Block]) -> list[Path]:
    """Write fidelity.md and fidelity.html into a folder, in which the pictures lie; return them."""
    markdown, html = folder / "fidelity.md", folder / "fidelity.html"
    write_all({markdown: to_markdown(blocks, folder), html: to_html(blocks, title)})
    return [markdown, html]


def write_verdicts(
    folder: Path,
    file: ClaimsFile,
    scores: Sequence[ScoreTable],
    *,
    title: str,
    about: str,
    tables: Mapping[str, pd.DataFrame] | None = None,
    middle: Sequence[Block] = (),
    end: Sequence[Block] = (),
) -> list[Path]:
    """Judge all statements and goals of a file; write fidelity_claims.csv and the page.

    folder: Made if it does not exist.
    file, scores: the claims, and the tables of scores by which they are judged.
    about: What the scores are of, in sentences.
    tables: Further tables to write: file name without suffix -> table.
    middle, end: Further blocks of the page: between statements and goals, and at the end.
    """
    statements, goals = judge(file.statements, scores, file), judge(file.goals, scores, file)
    blocks = [
        Heading(title, 1),
        Paragraph(about),
        *short_section(statements, goals),
        *statement_section(statements, file.note),
        *middle,
        *(goal_section(goals) if goals else []),
        *end,
    ]
    written = {**(tables or {}), "fidelity_claims": tabulate_claims([*statements, *goals])}
    folder.mkdir(parents=True, exist_ok=True)
    files = [write_table(folder, name, table) for name, table in written.items()]
    return files + write_page(folder, title, blocks)


def count_verdicts(judged: Sequence[JudgedStatement]) -> str:
    """Count the statements by verdict, in words, e.g. "9 reproduced, 2 undecided"."""
    counts = Counter(statement.verdict for statement in judged)
    order = (REPRODUCED, NOT_REPRODUCED, UNDECIDED, MISSING)
    return ", ".join(f"{counts[verdict]} {verdict}" for verdict in order if verdict in counts)


def short_section(
    statements: Sequence[JudgedStatement], goals: Sequence[JudgedStatement] = ()
) -> list[Block]:
    """Make the section that counts verdicts on statements and on goals."""
    counted = [
        f"{kind} {judged[0].name}-{judged[-1].name}: {count_verdicts(judged)}."
        for kind, judged in (("Statements", statements), ("Goals", goals))
        if judged
    ]
    return [Heading("In short"), Bullets(counted)]


def goal_section(goals: Sequence[JudgedStatement]) -> list[Block]:
    """Make the section on a project's goals: a table of all, then each goal's test and claims."""
    blocks: list[Block] = [
        Heading("Goals of the project"),
        TextTable(["", "to be reached", "verdict"], [[g.name, g.text, g.verdict] for g in goals]),
    ]
    for goal in goals:
        blocks += _explain(goal, f"{goal.text}. Test: {goal.definition}")
    return blocks


def _explain(judged: JudgedStatement, *paragraphs: str) -> list[Block]:
    return [
        Heading(f"{judged.name}: {judged.verdict}", 3),
        *map(Paragraph, paragraphs),
        Bullets([f"{claim.text}: {explain(claim)}." for claim in judged.claims]),
    ]


def statement_section(judged: Sequence[JudgedStatement], note: str) -> list[Block]:
    """Make the section on statements: a table of all, then each statement's test and claims.

    `note` tells where the definitions of the tests come from.
    """
    rows = [
        [s.name, s.text, s.verdict, " / ".join(claim.text for claim in s.claims)] for s in judged
    ]
    details = [_explain(s, f"Paper: {s.text}.", f"Test: {s.definition}") for s in judged]
    return [
        Heading("Statements"),
        Paragraph(
            "A statement is reproduced where all its claims are, not reproduced where one is not, "
            "else undecided (or missing, where the run lacks what a claim needs). A claim is "
            "reproduced or not where the paired t test, corrected by Holm, or the bootstrap "
            f"interval puts it wholly on one side. {note} "
            "Of each claim the comparison that is furthest from holding is shown."
        ),
        TextTable(["", "the paper says", "verdict", "claims tested"], rows),
        *itertools.chain.from_iterable(details),
    ]
