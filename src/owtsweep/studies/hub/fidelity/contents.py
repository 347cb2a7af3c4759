"""What the fidelity report says, in the order in which a reader asks for it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from owtsweep.figures.style import describe_window
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.fidelity.evidence import Evidence
from owtsweep.studies.hub.fidelity.number_section import number_section
from owtsweep.studies.hub.fidelity.numbers import lies_within_records
from owtsweep.verdicts.inference import MISSING, NOT_REPRODUCED, REPRODUCED, UNDECIDED
from owtsweep.verdicts.judgement import Judged, explain
from owtsweep.verdicts.page import Block, Bullets, Heading, Paragraph, Picture, Table

if TYPE_CHECKING:
    import pandas as pd

NO_VALUE = "–"


@dataclass(frozen=True)
class Findings:
    """Everything that the report tells of one run; `pictures` by stem."""

    name: str
    config: HubConfig
    evidence: Evidence
    table: pd.DataFrame
    numbers: pd.DataFrame
    judged: Sequence[Judged]
    consistency: pd.DataFrame
    pictures: Mapping[str, Path]


def document(findings: Findings) -> list[Block]:
    """The whole report."""
    return [
        *_head(findings),
        *_summary(findings),
        *_statements(findings),
        *number_section(findings.evidence, findings.numbers, findings.pictures),
        *_boundaries(findings),
        *_consistency(findings),
        *_missing(findings),
    ]


def _head(findings: Findings) -> list[Block]:
    config = findings.config
    records = f"{config.grid.replicates} records of {config.record.duration:g} s per natural period"
    return [
        Heading(f"How well run {findings.name} reproduces Ren et al. (2019)", 1),
        Paragraph(
            f"Tuning {config.tuning}, {records}, {describe_window(config.measures.window)}, seed "
            f"{config.seed}, schemes {', '.join(findings.evidence.schemes)}. Position is x + y, "
            "velocity vx + vy. Brackets are 95 % intervals: of means, t intervals over the records;"
            " of ratios of means, paired over the records (Fieller); of boundaries, a bootstrap "
            "over the records. A claim about many cells is tested in all of them with Holm's "
            "correction."
        ),
    ]


def _summary(findings: Findings) -> list[Block]:
    verdicts = [statement.verdict for statement in findings.judged]
    counts = [
        f"{verdicts.count(verdict)} {verdict}"
        for verdict in (REPRODUCED, NOT_REPRODUCED, UNDECIDED, MISSING)
        if verdict in verdicts
    ]
    known = findings.numbers.dropna(subset="reproduced")
    inside = sum(lies_within_records(row) == "yes" for row in _rows(known))
    missed = int(known["missed_by_factor_2"].sum())
    chosen = findings.table[findings.table["kind"].isin(["summary", "winner", "boundary"])]
    rows = [
        [row.item, _text(row.published), _bracket(row), row.agrees, row.why]
        for row in _rows(chosen)
    ]
    return [
        Heading("In short"),
        Bullets(
            [
                f"Statements F1-F11: {', '.join(counts)}.",
                f"Numbers of tables 6-9: {len(known)} of {len(findings.numbers)} in this run; "
                f"{inside} lie within the central 95 % of its single records, {missed} are missed "
                "by more than a factor of 2 in the mean.",
            ]
        ),
        Table(["item", "published", "this run", "agrees", "why"], rows, ["published", "this run"]),
        Paragraph(
            "A winner's number is the position MSE of the published winner over that of the best "
            "other scheme: below 1 it wins. log2 ratio: logarithm of reproduced over published, of "
            "the means."
        ),
    ]


def _statements(findings: Findings) -> list[Block]:
    rows = [
        [s.name, s.text, s.verdict, " / ".join(claim.text for claim in s.claims)]
        for s in findings.judged
    ]
    details: list[Block] = []
    for statement in findings.judged:
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
            "interval puts it wholly on one side. Definitions and thresholds were written "
            "down before any run was judged by them; winners and boundaries of earlier prototypes "
            "were known. Of each claim the comparison that is furthest from holding is shown."
        ),
        Table(["", "the paper says", "verdict", "claims tested"], rows),
        *details,
    ]


def _boundaries(findings: Findings) -> list[Block]:
    return [
        Heading("Boundary between HME1 and HME2"),
        Picture(
            findings.pictures["boundaries"],
            "Amplitude at which the mean position MSE of HME1 and HME2 is equal.",
        ),
    ]


def _consistency(findings: Findings) -> list[Block]:
    table = findings.consistency
    rows = []
    for scheme in findings.evidence.schemes:
        cells = table[table["scheme"] == scheme]
        counts = cells["verdict"].value_counts()
        rows.append(
            [
                scheme,
                _range(cells["nees"]),
                _range(cells["nis"]),
                ", ".join(f"{verdict} {count}" for verdict, count in counts.items()),
            ]
        )
    columns = ["NEES / 4, least to largest", "NIS / 2, least to largest"]
    return [
        Heading("Does the tuning know its own errors?"),
        Paragraph(
            "Mean NEES over 4 and mean NIS over 2 in each cell; 1 is consistent, more is optimistic"
            " (the covariance is too small), less pessimistic. A cell is consistent where both 95 %"
            " intervals hold 1. All cells: consistency.csv."
        ),
        Table(["scheme", *columns, "cells by verdict"], rows, columns),
    ]


def _missing(findings: Findings) -> list[Block]:
    lacking = findings.numbers[findings.numbers["reproduced"].isna()]
    items = []
    if len(lacking):
        tables = sorted({f"Table {row.table} {row.scheme}" for row in _rows(lacking)})
        items.append(f"Published numbers: {', '.join(tables)}.")
    for statement in findings.judged:
        absent = [item for claim in statement.claims for item in claim.missing]
        if absent:
            named = "; ".join(dict.fromkeys(absent))
            items.append(f"{statement.name}: {named}.")
    if not items:
        return []
    return [
        Heading("What this run lacks"),
        Paragraph("Conditions and schemes that the paper's results need and this run has not:"),
        Bullets(items),
    ]


def _rows(table: pd.DataFrame) -> Iterator[Any]:
    """Rows with their columns as attributes."""
    yield from table.itertuples(index=False)


def _range(values: pd.Series[float]) -> str:
    known = values.dropna()
    return f"{known.min():.2g} to {known.max():.2g}" if len(known) else NO_VALUE


def _text(value: float) -> str:
    return f"{value:.3g}" if value == value else NO_VALUE


def _bracket(row: Any) -> str:
    value, low, high = (getattr(row, name) for name in ("reproduced", "ci_low", "ci_high"))
    if low != low:
        return _text(value)
    return f"{_text(value)} [{_text(low)}, {_text(high)}]"
