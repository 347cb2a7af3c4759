"""Examines the rows of a block (unit of work): can they be stored, which cases have no number?"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from owtsweep.errors import printable
from owtsweep.sweep.schema import STATUSES, needed_columns
from owtsweep.sweep.study import Block, Study

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Setback:
    """The cases of one block (unit of work) that have no number, for one reason.

    These cases failed, or the scheme cannot compute them. `label` is the block's label, and `cases`
    the number of these cases.
    """

    label: str
    reason: str
    cases: int


def require_rows(study: Study, config: Any, rows: pd.DataFrame) -> None:
    """Check, before the rows of a block (unit of work) are stored, that tables can use the rows.

    The needed columns are those of `schema.needed_columns`.

    Raises
    ------
    TypeError
        If `rows` is not a DataFrame.
    ValueError
        If there is no row, a needed column is missing, or a status is unknown.
    """
    columns = getattr(rows, "columns", None)
    if columns is None:
        raise TypeError(f"the study's rows are a {type(rows).__name__}, not a DataFrame")
    missing = [name for name in needed_columns(study, config) if name not in columns]
    if missing:
        raise ValueError(f"the study's rows have no column {', '.join(missing)}")
    if not len(rows):
        raise ValueError("the study gave no row")
    unknown = sorted(map(repr, set(rows["status"]) - set(STATUSES)))
    if unknown:
        raise ValueError(f"status {', '.join(unknown)} is none of {', '.join(STATUSES)}")


def collect_setbacks(block: Block, rows: pd.DataFrame, status: str) -> list[Setback]:
    """Count the cases of a block (unit of work) that have the given status, by their reason.

    Return one `Setback` per reason; [] if no row has this status.
    """
    if not (rows["status"].to_numpy() == status).any():
        return []  # saves time: counting nothing with pandas takes longer than writing a shard
    reasons = rows.loc[rows["status"] == status, "reason"].fillna("no reason given").value_counts()
    each = block.cases_per_row
    return [
        Setback(block.label, printable(str(reason)), each * int(n)) for reason, n in reasons.items()
    ]
