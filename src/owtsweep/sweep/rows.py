"""Checks that the rows of a block can later be identified, sorted and counted."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from owtsweep.results.status import FAILED, OK, UNABLE

if TYPE_CHECKING:
    import pandas as pd

    from owtsweep.sweep.study import Study

STATUSES = (OK, FAILED, UNABLE)


def require_rows(study: Study, config: Any, rows: pd.DataFrame) -> None:
    """Refuse rows that could not be made into tables, before they are stored.

    Raises
    ------
    TypeError
        If they are not a DataFrame.
    ValueError
        If a column is missing, or if a status is unknown.
    """
    columns = getattr(rows, "columns", None)
    if columns is None:
        raise TypeError(f"the study's rows are a {type(rows).__name__}, not a DataFrame")
    conditions = [c.name for c in study.conditions(config) if not c.expands]
    needed = ["status", "reason", *study.engine(config).sort_columns(), *conditions]
    missing = [name for name in dict.fromkeys(needed) if name not in columns]
    if missing:
        raise ValueError(f"the study's rows have no column {', '.join(missing)}")
    unknown = sorted(map(repr, set(rows["status"]) - set(STATUSES)))
    if unknown:
        raise ValueError(f"status {', '.join(unknown)} is none of {', '.join(STATUSES)}")
