"""Make the sections of the report on Ren et al. (2019) that compare numbers and covariances."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pandas as pd

from experiments.ren2019.consistency import FREEDOM
from experiments.ren2019.numbers import lies_within_records
from owtsweep.verdicts.inference import MISSING, JudgedStatement
from owtsweep.verdicts.page import Block, Bullets, Heading, Paragraph, TextTable

NO_VALUE = "–"
NUMBER_COLUMNS = ("published", "this run", "95 % of records", "chance", "ratio")


def number_table(numbers: pd.DataFrame) -> TextTable:
    """Make a table of the published numbers beside the run's numbers, one row per published number.

    `numbers` has the columns scheme, measure, published, printed, and the keys of
    `numbers.compare_number`'s result.
    """
    rows = []
    each: Any = numbers.itertuples()
    for row in each:
        agrees, of_run = lies_within_records(row), [NO_VALUE] * 4
        if agrees != MISSING:
            of_run = [
                f"{row.reproduced:.2e} [{row.ci_low:.2e}, {row.ci_high:.2e}]",
                f"{row.record_low:.2e} to {row.record_high:.2e}",
                format_chance(row.chance),
                format_ratio(row.ratio),
            ]
        rows.append([row.scheme, row.measure, format_published(row), *of_run, agrees])
    return TextTable(["scheme", "measure", *NUMBER_COLUMNS, "agrees"], rows, NUMBER_COLUMNS)


def consistency_section(table: pd.DataFrame, schemes: Sequence[str]) -> list[Block]:
    """Make the section on consistency: for each scheme, the ranges of NEES and NIS, and verdicts.

    `table` is that of `judge_consistency`; `schemes` are listed in their order.
    """
    columns = [f"{name.upper()} / {n:g}, least to largest" for name, n in FREEDOM.items()]
    rows = []
    for scheme in schemes:
        cells = table[table["scheme"] == scheme]
        counts = ", ".join(f"{word} {n}" for word, n in cells["verdict"].value_counts().items())
        rows.append([scheme, *(_describe_range(cells[name]) for name in FREEDOM), counts])
    means = " and ".join(f"mean {name.upper()} over {n:g}" for name, n in FREEDOM.items())
    return [
        Heading("Does the tuning know its own errors?"),
        Paragraph(
            f"{means[0].upper()}{means[1:]} in each cell; 1 is consistent, more is optimistic"
            " (the covariance is too small), less pessimistic. A cell is consistent where both 95 %"
            " intervals hold 1. All cells: consistency.csv."
        ),
        TextTable(["scheme", *columns, "cells by verdict"], rows, columns),
    ]


def _describe_range(values: pd.Series[float]) -> str:
    finite = values.dropna()
    return f"{finite.min():.2g} to {finite.max():.2g}" if len(finite) else NO_VALUE


def missing_section(numbers: pd.DataFrame, judged: Sequence[JudgedStatement]) -> list[Block]:
    """Make the section on the data that the run lacks for judging all published results.

    Returns an empty list if no data are missing.

    Parameters
    ----------
    numbers
        One row per published number. Columns table, scheme, and reproduced, which is NaN if the run
        lacks the number.
    judged
        The statements with their claims.
    """
    lacking: Any = numbers[numbers["reproduced"].isna()].itertuples(index=False)
    tables = sorted({f"Table {row.table} {row.scheme}" for row in lacking})
    items = [f"Published numbers: {', '.join(tables)}."] if tables else []
    for statement in judged:
        absent = [item for claim in statement.claims for item in claim.missing]
        if absent:
            items.append(f"{statement.name}: {'; '.join(dict.fromkeys(absent))}.")
    if not items:
        return []
    return [
        Heading("What this run lacks"),
        Paragraph("Conditions and schemes that the paper's results need and this run has not:"),
        Bullets(items),
    ]


def format_published(row: Any) -> str:
    """Format a published number; where it is a corrected misprint, with what is printed.

    The attributes of `row` are `published` (the number that is judged) and `printed`.
    """
    mark = "" if row.printed == row.published else f" (misprinted as {row.printed:.2e})"
    return f"{row.published:.2e}{mark}"


def format_value(value: float) -> str:
    """Format a number to three significant digits; NaN becomes a dash."""
    return f"{value:.3g}" if value == value else NO_VALUE


def format_ratio(value: float) -> str:
    """Format a ratio with two decimals, or with two significant digits if it is below 0.1."""
    return f"{value:.2f}" if value >= 0.1 else f"{value:.2g}"


def format_chance(value: float) -> str:
    """Format a probability with two digits; NaN becomes a dash."""
    return f"{value:.2g}" if value == value else NO_VALUE


def format_interval(row: Any) -> str:
    """Format a number followed by its 95 % interval in brackets, if the interval is known.

    The attributes of `row` are `reproduced` (the number), `ci_low` and `ci_high` (NaN if unknown).
    """
    value, low, high = map(format_value, (row.reproduced, row.ci_low, row.ci_high))
    return value if low == NO_VALUE else f"{value} [{low}, {high}]"
