"""Examines the rows of a block (unit of work): names, types and values of their columns.

The seal of a shard (a stored file of rows) shows damage, but not forgery: whoever has this package
can seal other rows. So rows are checked when they are read, as before they are stored.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa

from owtsweep.config import Config
from owtsweep.errors import printable
from owtsweep.sweep.study import FAILED, OK, UNABLE, Block, Square, Study

if TYPE_CHECKING:
    import pandas as pd


STATUSES = (OK, FAILED, UNABLE)
TEXT, CATEGORIES, NUMBERS, FLAGS, NOTHING = "text", "categories", "numbers", "flags", "nothing"
_KINDS = {
    **dict.fromkeys(("string", "large_string"), TEXT),
    **dict.fromkeys(("halffloat", "float", "double"), NUMBERS),
    **{f"{sign}int{bits}": NUMBERS for sign in ("", "u") for bits in (8, 16, 32, 64)},
    "bool": FLAGS,
    "null": NOTHING,
}
#: A mean square is 0 or at least this: no number of a configuration is smaller than 1e-30, and no
#: error smaller than the rounding of such a number.
LEAST_SQUARE = 1e-300
#: What `Engine.row_types` says of a column -> the kinds of values that the column may hold.
_ALLOWED: Mapping[type | None, tuple[str, ...]] = {
    str: (TEXT, CATEGORIES, NOTHING),
    float: (NUMBERS, NOTHING),
    Square: (NUMBERS, NOTHING),
    None: (TEXT, CATEGORIES, NUMBERS, FLAGS, NOTHING),
}
#: Column -> `str`, `float` (a number), `Square`, or None where the study does not say.
Needed = Mapping[str, type | None]


@dataclass(frozen=True)
class Setback:
    """The cases of one block (unit of work) that have no number, for one reason.

    These cases failed, or the scheme cannot compute them. `label` is the block's label, and `cases`
    the number of these cases.
    """

    label: str
    reason: str
    cases: int


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


class WrongRows(Exception):
    """The error for rows of which no table can be made; the message says what is wrong."""


def needed_columns(study: Study, config: Config) -> dict[str, type | None]:
    """Return the columns that every row of a study must have, by name, with their types.

    A type is `str`, `float`, `Square` or None, which stands for any type. The columns are `status`
    and `reason`, those of the engine's `sort_columns` and `row_types`, and the conditions that do
    not expand.
    """
    engine = study.engine(config)
    conditions = [c.name for c in study.conditions(config) if not c.expands]
    needed = dict.fromkeys([*engine.sort_columns(), *conditions])
    return {"status": str, "reason": str, **needed, **engine.row_types}


def kinds_of(schema: pa.Schema) -> dict[str, str]:
    """Return column name -> kind of the column's values, for a `pyarrow.Schema`.

    A kind is "text", "categories" (coded text), "numbers", "flags" (true and false), or "nothing"
    (missing values only).

    Raises WrongRows if two columns have the same name, or a column is of none of these kinds.
    """
    kinds: dict[str, str] = {}
    for name, type_ in zip(schema.names, schema.types, strict=True):
        kind = _KINDS.get(str(type_))
        if kind is None and pa.types.is_dictionary(type_):
            kind = CATEGORIES if _KINDS.get(str(type_.value_type)) == TEXT else None
        if kind is None:
            raise WrongRows(
                f"its column {name} holds {type_}; a column holds text, numbers or true and false"
            )
        if name in kinds:
            raise WrongRows(f"it has two columns {name}")
        kinds[name] = kind
    return kinds


def check_columns(schema: pa.Schema, needed: Needed) -> None:
    """Check that a `pyarrow.Schema` has all needed columns, and that their types are allowed.

    `needed` is what `needed_columns` returns.

    Raises WrongRows if a needed column is missing or of another type, two columns have the same
        name, or a column holds no text, numbers or flags.
    """
    kinds = kinds_of(schema)
    for name, type_ in needed.items():
        if name not in kinds:
            raise WrongRows(f"it has no column {name}")
        if kinds[name] not in _ALLOWED[type_]:
            belongs = TEXT if type_ is str else NUMBERS
            raise WrongRows(f"its column {name} holds {kinds[name]} where {belongs} belong")


def check_table(table: pa.Table, needed: Needed) -> None:
    """Check the values of a `pyarrow.Table` whose columns `check_columns` has checked.

    Raises WrongRows if there are no rows, a status is unknown, a needed text other than `reason` is
        missing, or a column of squares holds a number between 0 and `LEAST_SQUARE` (or its
        negative).
    """
    for name, type_ in needed.items():
        if type_ is Square:
            _check_squares(name, table[name])
        if type_ is str and name != "reason" and table[name].null_count:
            raise WrongRows(f"its column {name} has an empty value")
    if "status" in needed:
        check_statuses(frozenset(table["status"].unique().to_pylist()))


def _check_squares(name: str, column: pa.ChunkedArray) -> None:
    values = column.to_numpy().astype(float)  # what is missing becomes NaN
    tiny = values[(values != 0.0) & (np.abs(values) < LEAST_SQUARE)]
    if len(tiny):
        raise WrongRows(
            f"its column {name} holds {tiny[0]:.3g}, but no mean square is so near to 0"
        )


def check_statuses(statuses: frozenset[str]) -> None:
    """Check `statuses`, the distinct values of the column `status`.

    Raises WrongRows if there is no value, or a value is not in `STATUSES`.
    """
    if not statuses:
        raise WrongRows("it has no rows")
    unknown = ", ".join(sorted(repr(status)[:40] for status in statuses if status not in STATUSES))
    if unknown:
        raise WrongRows(f"status {unknown} is none of {', '.join(STATUSES)}")
