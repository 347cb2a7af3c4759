"""Looks up the scores of several records, for tests of statements."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from experiments.simpson2025.scenarios import Scenario
from owtsweep.arrays import Array

if TYPE_CHECKING:
    import pandas as pd

#: Columns that tell what a row's value is of, besides the record.
KEYS = (
    "sensors", "sea", "gravity", "weight", "scheme", "tuning", "direction", "quantity", "measure",
)  # fmt: skip


@dataclass(frozen=True)
class Scores:
    """The scores of several records.

    Attributes
    ----------
    table
        As `scores.tabulate` returns it.
    """

    table: pd.DataFrame

    @property
    def records(self) -> int:
        """The number of records."""
        return int(self.table["replicate"].nunique())

    @cached_property
    def _index(self) -> dict[tuple[Any, ...], Array]:
        ordered = self.table.sort_values("replicate", kind="stable")
        groups = ordered.groupby(list(KEYS), sort=False)["value"]
        return {key: values.to_numpy(dtype=float) for key, values in groups}

    def find(self, scenario: Scenario, direction: str, quantity: str, measure: str) -> Array | None:
        """Return a score of all records, shape (records,); None if there is no such score."""
        return self._index.get(
            (
                scenario.sensors, scenario.sea, scenario.gravity, scenario.weight, scenario.scheme,
                scenario.tuning, direction, quantity, measure,
            )
        )  # fmt: skip

    def list_quantities(self, scenario: Scenario, direction: str, measure: str) -> list[str]:
        """Return the quantities of which there is a measure, in the order of the table."""
        wanted = (
            scenario.sensors, scenario.sea, scenario.gravity, scenario.weight, scenario.scheme,
            scenario.tuning, direction,
        )  # fmt: skip
        return [key[7] for key in self._index if key[:7] == wanted and key[8] == measure]
