"""A table with one row per published item and the run's result for it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.verdicts.inference import MISSING, NOT_REPRODUCED, REPRODUCED, Decision, Estimate
from owtsweep.verdicts.numbers import lies_within_records
from owtsweep.verdicts.statements import JudgedStatement

if TYPE_CHECKING:
    import pandas as pd

NAN = float("nan")


@dataclass(frozen=True)
class Item:
    """A published item: `kind` is number, statement, boundary, winner or summary.

    `reproduced` has its 95 % interval, NaN where there is none; `agrees` is yes, no, undecided,
    missing, a verdict, or empty where nothing is published.
    """

    item: str
    kind: str
    published: float = NAN
    reproduced: float = NAN
    ci_low: float = NAN
    ci_high: float = NAN
    agrees: str = MISSING
    why: str = ""

    def judged(self, result: Decision | Estimate, verdict: str, why: str) -> Item:
        """The same item with a run's result; `agrees` is yes, no, undecided, missing or empty."""
        return replace(
            self, reproduced=result.value, ci_low=result.low, ci_high=result.high, why=why,
            agrees={REPRODUCED: "yes", NOT_REPRODUCED: "no"}.get(verdict, verdict),
        )  # fmt: skip


def make_table(rows: Sequence[Item]) -> pd.DataFrame:
    """Make the table with the columns of `Item` and, before `agrees`, reproduced / published."""
    import pandas as pd

    table = pd.DataFrame(rows)
    ratio = table["reproduced"] / table["published"]
    table.insert(list(table).index("agrees"), "ratio", ratio)
    return table


def statement_row(judged: JudgedStatement) -> Item:
    """The row of a statement; `published` is the threshold of the decision behind its verdict."""
    worst = judged.settling.deciding
    return Item(
        judged.name, "statement", worst.threshold, worst.value, worst.low, worst.high,
        agrees=judged.verdict, why=judged.why,
    )  # fmt: skip


def number_rows(numbers: pd.DataFrame) -> Iterator[Item]:
    """One row per published number.

    `numbers` has the columns table, scheme, measure, published, why, and those of a run.
    """
    rows: Any = numbers.itertuples(index=False)
    for row in rows:
        yield Item(
            f"table {row.table} {row.scheme} {row.measure}", "number", row.published,
            row.reproduced, row.ci_low, row.ci_high, lies_within_records(row), row.why,
        )  # fmt: skip


def distance_rows(numbers: pd.DataFrame, goals: Mapping[tuple[str, ...], float]) -> Iterator[Item]:
    """Median and 80th percentile of |log2(reproduced / published)|, by group of schemes.

    Parameters
    ----------
    numbers
        Columns scheme and log2.
    goals
        Group of schemes -> the median that counts as agreement.
    """
    for schemes, goal in goals.items():
        chosen = numbers[numbers["scheme"].isin(schemes)]
        distances = chosen["log2"].abs().dropna()
        complete = len(distances) == len(chosen)
        for label, quantile, limit in (("median", 0.5, goal), ("80th percentile", 0.8, NAN)):
            value = float(distances.quantile(quantile))
            agrees, why = "", f"over {len(distances)} of {len(chosen)} numbers"
            if np.isfinite(value):
                why += f", a factor of {2.0**value:.2f}"
            if np.isfinite(limit):
                # If numbers are missing, the distance is that of a different set of numbers.
                agrees = ("yes" if value <= limit else "no") if complete else MISSING
                why += f"; agreement: at most {limit:g}"
            name = f"{label} |log2 ratio|, {', '.join(schemes)}"
            yield Item(name, "summary", reproduced=value, agrees=agrees, why=why)
