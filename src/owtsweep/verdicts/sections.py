"""Make sections of a report on published results that are the same for every study."""

from __future__ import annotations

from collections.abc import Sequence

from owtsweep.verdicts.inference import MISSING, NOT_REPRODUCED, REPRODUCED, UNDECIDED
from owtsweep.verdicts.page import Block, Bullets, Heading, Paragraph, TextTable
from owtsweep.verdicts.statements import JudgedStatement, explain


def count_verdicts(judged: Sequence[JudgedStatement]) -> str:
    """Count the statements by verdict, in words, e.g. "9 reproduced, 2 undecided".

    Verdicts that no statement has are left out.
    """
    verdicts = [statement.verdict for statement in judged]
    return ", ".join(
        f"{verdicts.count(verdict)} {verdict}"
        for verdict in (REPRODUCED, NOT_REPRODUCED, UNDECIDED, MISSING)
        if verdict in verdicts
    )


def short_section(
    statements: Sequence[JudgedStatement], goals: Sequence[JudgedStatement] = ()
) -> list[Block]:
    """Make the section that counts verdicts on statements and on goals."""
    lists = {"Statements": statements, "Goals": goals}
    return [
        Heading("In short"),
        Bullets(
            [
                f"{kind} {judged[0].name}-{judged[-1].name}: {count_verdicts(judged)}."
                for kind, judged in lists.items()
                if judged
            ]
        ),
    ]


def goal_section(goals: Sequence[JudgedStatement]) -> list[Block]:
    """Make the section on a project's goals: a table of all, then each goal's test and claims."""
    blocks: list[Block] = [
        Heading("Goals of the project"),
        TextTable(["", "to be reached", "verdict"], [[g.name, g.text, g.verdict] for g in goals]),
    ]
    for goal in goals:
        blocks += [
            Heading(f"{goal.name}: {goal.verdict}", 3),
            Paragraph(f"{goal.text}. Test: {goal.definition}"),
            Bullets([f"{claim.text}: {explain(claim)}." for claim in goal.claims]),
        ]
    return blocks


def statement_section(judged: Sequence[JudgedStatement], note: str) -> list[Block]:
    """Make the section on statements: a table of all, then each statement's test and claims.

    Parameters
    ----------
    judged
        The statements with their claims and verdicts.
    note
        A sentence that tells where the definitions of the tests come from.
    """
    rows = [
        [s.name, s.text, s.verdict, " / ".join(claim.text for claim in s.claims)] for s in judged
    ]
    details: list[Block] = []
    for statement in judged:
        details += [
            Heading(f"{statement.name}: {statement.verdict}", 3),
            Paragraph(f"Paper: {statement.text}."),
            Paragraph(f"Test: {statement.definition}"),
            Bullets([f"{claim.text}: {explain(claim)}." for claim in statement.claims]),
        ]
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
        *details,
    ]
