"""The section of the fidelity report on the 64 numbers of tables 6-9."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from owtsweep.studies.hub.fidelity.evidence import Cell, Evidence
from owtsweep.studies.hub.fidelity.reasons import reason
from owtsweep.studies.hub.fidelity.statements import TABLE_CELLS
from owtsweep.verdicts.page import Block, Bullets, Heading, Paragraph, Picture
from owtsweep.verdicts.sections import number_table

if TYPE_CHECKING:
    import pandas as pd


def number_section(
    evidence: Evidence, numbers: pd.DataFrame, pictures: Mapping[str, Path]
) -> list[Block]:
    """The blocks of the section: figures, four tables, and the reasons for missed numbers.

    Parameters
    ----------
    numbers
        The result of `compare_numbers`.
    pictures
        File name without suffix -> file: published_against_reproduced and ratios.
    """
    return [
        Heading("Numbers of tables 6-9"),
        Paragraph(
            "The paper has one record, so its number is held against single records of this run: "
            "it agrees where it lies within their central 95 %. Quantile: the part of the records "
            "below the published number."
        ),
        Picture(
            pictures["published_against_reproduced"],
            "Published against reproduced MSE; bars hold 95 % of single records.",
        ),
        Picture(
            pictures["ratios"],
            "Reproduced over published MSE, table by table; bars hold 95 % of single records.",
        ),
        *(block for number in TABLE_CELLS for block in _table(numbers, number)),
        *_missed(evidence, numbers),
    ]


def _table(numbers: pd.DataFrame, number: int) -> list[Block]:
    cell = TABLE_CELLS[number]
    condition = f"natural period {cell.natural_period:g} s, amplitude {cell.amplitude:g} m"
    chosen = numbers[numbers["table"] == number]
    return [
        Heading(f"Table {number}: {condition}", 3),
        number_table(chosen.itertuples(index=False)),
    ]


def _missed(evidence: Evidence, numbers: pd.DataFrame) -> list[Block]:
    missed: Any = numbers[numbers["missed_by_factor_2"]].itertuples(index=False)
    items = []
    for row in missed:
        cell = Cell(row.natural_period, row.amplitude)
        why = reason(evidence, row.scheme, cell, row.measure, row.published)
        name = f"Table {row.table}, {row.scheme} {row.measure}"
        items.append(f"{name}, {row.ratio:.2f} times the print: {why}.")
    heading = Heading("Numbers missed by more than a factor of 2", 3)
    if not items:
        return [heading, Paragraph("None.")]
    return [
        heading,
        Paragraph(
            "Parts of an MSE at the amplitude N: N² A (motion), 2 N C (their product), F (noise). "
            "Tables 7 and 8 imply the print's own F, C neglected; the rest of a number is its "
            "motion term."
        ),
        Bullets(items),
    ]
