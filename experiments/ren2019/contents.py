"""Write the contents of the report on how well a run reproduces Ren et al. (2019)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from experiments.command import read_data
from experiments.ren2019 import sections as own
from experiments.ren2019.evidence import TABLE_CELLS, Cell, Evidence
from experiments.ren2019.numbers import lies_within_records
from experiments.ren2019.reasons import reason
from owtsweep.figures.style import describe_window
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.describe import describe_in_a_line
from owtsweep.verdicts.inference import JudgedStatement, explain
from owtsweep.verdicts.page import Block, Bullets, Heading, Paragraph, Picture, TextTable
from owtsweep.verdicts.report import count_verdicts, statement_section
from owtsweep.verdicts.score_table import Boundary

#: Paragraphs of the report, and what is said below its pictures.
TEXTS = read_data(__file__)
#: Pictures of the numbers of tables 6-9.
PLOTS = ("published_against_reproduced", "ratios")


def document(
    name: str,
    config: HubConfig,
    evidence: Evidence,
    tables: Mapping[str, pd.DataFrame],
    judged: Sequence[JudgedStatement],
    along_x: Sequence[JudgedStatement],
    note: str,
    pictures: Mapping[str, Path],
) -> list[Block]:
    """Write the whole report on one run, as blocks (headings, paragraphs, tables) of a page.

    Parameters
    ----------
    name
        Name of the run in the report.
    config, evidence
        The run's configuration and results.
    tables
        File name without suffix -> table: fidelity, fidelity_numbers and consistency.
    judged
        The statements F1 to F11 of Ren et al. (2019), with the verdicts on them.
    along_x
        The first of these statements, judged in x alone.
    note
        A sentence that tells where the definitions of the tests come from.
    pictures
        Figure name -> PNG file: published_against_reproduced, ratios and boundaries.
    """
    numbers = tables["fidelity_numbers"]
    window, schemes = describe_window(config.measures.window), ", ".join(evidence.schemes)
    return [
        Heading(f"How well run {name} reproduces Ren et al. (2019)", 1),
        Paragraph(
            TEXTS["judged"].format(run=describe_in_a_line(config), window=window, schemes=schemes)
        ),
        *_summary(tables["fidelity"], numbers, judged, along_x),
        *statement_section(judged, note),
        *_x_section(evidence, judged, along_x),
        *_number_section(evidence, numbers, pictures),
        Heading("Boundary between HME1 and HME2"),
        Picture(pictures["boundaries"], TEXTS["boundaries"]),
        *own.consistency_section(tables["consistency"], evidence.schemes),
        *own.missing_section(numbers, judged),
    ]


def _summary(
    table: pd.DataFrame,
    numbers: pd.DataFrame,
    judged: Sequence[JudgedStatement],
    along_x: Sequence[JudgedStatement],
) -> list[Block]:
    present = numbers.dropna(subset="reproduced")
    inside = sum(lies_within_records(row) == "yes" for row in present.itertuples())
    missed = int(present["missed_by_factor_2"].sum())
    chosen: Any = table[table["kind"].isin(["summary", "winner", "boundary"])].itertuples()
    rows = [
        [row.item, own.format_value(row.published), own.format_interval(row), row.agrees, row.why]
        for row in chosen
    ]
    values = ["published", "this run"]
    return [
        Heading("In short"),
        Bullets(
            [
                f"Statements F1-F11: {count_verdicts(judged)}.",
                f"F1-F5 in x alone: {count_verdicts(along_x)}; {_name_differing(judged, along_x)}.",
                f"Numbers of tables 6-9: {len(present)} of {len(numbers)} in this run; "
                f"{inside} agree as prints of one record ({0.95 * len(present):.0f} would, if all "
                f"were), {missed} are missed by more than a factor of 2 in the mean.",
            ]
        ),
        TextTable(["item", *values, "agrees", "why"], rows, values),
        Paragraph(TEXTS["winners"]),
    ]


def _name_differing(judged: Sequence[JudgedStatement], along_x: Sequence[JudgedStatement]) -> str:
    """Say which statements have one verdict in x + y and another in x alone."""
    pairs = zip(judged, along_x, strict=False)
    names = [both.name for both, alone in pairs if both.verdict != alone.verdict]
    return f"other than in x + y: {', '.join(names)}" if names else "all as in x + y"


def _x_section(
    evidence: Evidence, judged: Sequence[JudgedStatement], along_x: Sequence[JudgedStatement]
) -> list[Block]:
    """Set the verdicts, claims and boundaries in x alone beside those in x + y."""
    sides = ["x + y", "x alone"]
    verdicts, claims = [], []
    for both, alone in zip(judged, along_x, strict=False):
        hangs = "no" if both.verdict == alone.verdict else "yes"
        verdicts.append([both.name, both.verdict, alone.verdict, hangs])
        for first, second in zip(both.claims, alone.claims, strict=True):
            claims.append([both.name, first.text, explain(first), explain(second)])
    in_x = evidence.along_x.boundaries
    boundaries = [
        [f"{period:g} s", _describe_boundary(value), _describe_boundary(in_x[period])]
        for period, value in evidence.boundaries.items()
        if period in in_x
    ]
    return [
        Heading("F1 to F5 in x + y, and in x alone"),
        Paragraph(TEXTS["in_x"]),
        TextTable(["", *sides, "hangs on the choice?"], verdicts),
        TextTable(["", "claim", *sides], claims),
        TextTable(["boundary (m) at", *sides], boundaries, sides),
    ]


def _describe_boundary(boundary: Boundary) -> str:
    if boundary.wins:
        return "none" if boundary.wins == "neither" else f"none: {boundary.wins} is better"
    return f"{boundary.value:.3g} [{boundary.low:.3g}, {boundary.high:.3g}]"


def _number_section(
    evidence: Evidence, numbers: pd.DataFrame, pictures: Mapping[str, Path]
) -> list[Block]:
    """Write the section on the 64 numbers of tables 6-9 of Ren et al. (2019).

    The section has two figures, four tables, and the reasons for numbers that the run misses by
    more than a factor of 2. `numbers` is the result of `numbers.compare_numbers`; `pictures` maps
    figure names to PNG files.
    """
    corrected: Any = numbers[numbers["printed"] != numbers["published"]].itertuples()
    misprints = "".join(
        f" Table {row.table}, {row.scheme} {row.measure}: {own.format_published(row)}."
        for row in corrected
    )
    blocks: list[Block] = [
        Heading("Numbers of tables 6-9"),
        Paragraph(TEXTS["records"]),
        *(Picture(pictures[name], TEXTS[name] + misprints) for name in PLOTS),
    ]
    for number, cell in TABLE_CELLS.items():
        condition = f"natural period {cell.natural_period:g} s, amplitude {cell.amplitude:g} m"
        blocks += [
            Heading(f"Table {number}: {condition}", 3),
            own.number_table(numbers[numbers["table"] == number]),
        ]
    blocks.append(Heading("Numbers missed by more than a factor of 2", 3))
    items = []
    missed: Any = numbers[numbers["missed_by_factor_2"]].itertuples()
    for row in missed:
        cell = Cell(row.natural_period, row.amplitude)
        why = reason(evidence, row.scheme, cell, row.measure, row.published)
        name = f"Table {row.table}, {row.scheme} {row.measure}"
        told = f"{own.format_ratio(row.ratio)} times {own.format_published(row)}"
        items.append(f"{name}, {told}: {why}.")
    if not items:
        return [*blocks, Paragraph("None.")]
    return [*blocks, Paragraph(TEXTS["parts"]), Bullets(items)]
