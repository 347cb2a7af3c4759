"""Cases that ended without a number, counted by block and reason."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from owtsweep.sweep.study import Block

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Setback:
    """Cases of a block without a number for the same reason: they failed, or are impossible."""

    label: str
    reason: str
    cases: int


def collect_setbacks(block: Block, rows: pd.DataFrame, status: str) -> list[Setback]:
    """The cases of a block whose rows have this status, by reason."""
    if "status" not in rows.columns or "reason" not in rows.columns:
        return []  # such rows are refused when they are sealed
    if not (rows["status"].to_numpy() == status).any():
        return []  # saves time: counting nothing with pandas takes longer than writing a shard
    reasons = rows.loc[rows["status"] == status, "reason"].fillna("no reason given").value_counts()
    each = block.cases_per_row
    return [Setback(block.label, str(reason), each * int(n)) for reason, n in reasons.items()]
