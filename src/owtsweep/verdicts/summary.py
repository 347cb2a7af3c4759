"""Make a table with one row per published item, beside the run's result for this item."""

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
    """A published item, e.g. a number or a statement, and the run's result for this item.

    Attributes
    ----------
    item
        The name of the item.
    kind
        "number", "statement", "boundary", "winner" or "summary".
    published
        The published value; NaN if none is published.
    reproduced, ci_low, ci_high
        The run's value and the ends of its 95 % interval; NaN where unknown.
    agrees
        Whether the run agrees: "yes", "no", "undecided" or "missing"; for a statement, its verdict;
        "" if there is nothing to agree with.
    why
        The reason for `agrees` or for a difference, in words.
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
        """Return a copy of the item that holds a run's result and the reason `why`.

        The verdict "reproduced" sets `agrees` to "yes", and "not reproduced" to "no". Any other
        verdict becomes `agrees` unchanged.
        """
        return replace(
            self, reproduced=result.value, ci_low=result.low, ci_high=result.high, why=why,
            agrees={REPRODUCED: "yes", NOT_REPRODUCED: "no"}.get(verdict, verdict),
        )  # fmt: skip


def make_table(rows: Sequence[Item]) -> pd.DataFrame:
    """Make the table of published items: one row per item, the attributes of `Item` as columns.

    A further column `ratio` before `agrees` holds reproduced / published.
    """
    import pandas as pd

    table = pd.DataFrame(rows)
    ratio = table["reproduced"] / table["published"]
    table.insert(list(table).index("agrees"), "ratio", ratio)
    return table


def statement_row(judged: JudgedStatement) -> Item:
    """Make the summary's row on a statement.

    A statement makes claims, and a claim consists of decisions, each of which compares a quantity
    with a threshold. The row's numbers are those of the decision that settles the verdict:
    `published` is the threshold, `reproduced` is the run's value.
    """
    worst = judged.settling.deciding
    return Item(
        judged.name, "statement", worst.threshold, worst.value, worst.low, worst.high,
        agrees=judged.verdict, why=judged.why,
    )  # fmt: skip


def number_rows(numbers: pd.DataFrame) -> Iterator[Item]:
    """Yield the summary's rows on published numbers, one row per number.

    `numbers` has the columns table, scheme, measure, published and why, and the keys of
    `numbers.compare_number`'s result.
    """
    rows: Any = numbers.itertuples(index=False)
    for row in rows:
        yield Item(
            f"table {row.table} {row.scheme} {row.measure}", "number", row.published,
            row.reproduced, row.ci_low, row.ci_high, lies_within_records(row), row.why,
        )  # fmt: skip


def distance_rows(numbers: pd.DataFrame, goals: Mapping[tuple[str, ...], float]) -> Iterator[Item]:
    """Yield two rows for each group of schemes: how far the run is from the published numbers.

    The first row holds the median of |log2(reproduced / published)| over the group's numbers, the
    second row the 80th percentile.

    Parameters
    ----------
    numbers
        One row per published number. Columns scheme and log2, which is NaN if the run lacks the
        number.
    goals
        Group of schemes -> the largest median that counts as agreement. If the run lacks numbers
        of a group, the median's `agrees` is "missing".
    """
    for schemes, goal in goals.items():
        chosen = numbers[numbers["scheme"].isin(schemes)]
        distances = chosen["log2"].abs().dropna()
        complete = len(distances) == len(chosen)
        for label, quantile, limit in (("median", 0.5, goal), ("80th percentile", 0.8, NAN)):
            with np.errstate(over="ignore", invalid="ignore"):  # the value 0 is infinitely far
                value = float(distances.quantile(quantile))
                factor = np.exp2(value)
            agrees, why = "", f"over {len(distances)} of {len(chosen)} numbers"
            if np.isfinite(value):
                why += f", a factor of {factor:.2f}"
            if np.isfinite(limit):
                # If numbers are missing, the distance is that of a different set of numbers.
                agrees = ("yes" if value <= limit else "no") if complete else MISSING
                why += f"; agreement: at most {limit:g}"
            name = f"{label} |log2 ratio|, {', '.join(schemes)}"
            yield Item(name, "summary", reproduced=value, agrees=agrees, why=why)
