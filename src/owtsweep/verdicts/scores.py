"""Keeps and looks up the scores of several records, and makes claims of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.arrays import Array
from owtsweep.verdicts.inference import Claim, Side
from owtsweep.verdicts.means import claim_means

if TYPE_CHECKING:
    import pandas as pd

#: The name of a scenario, i.e. of what is run, and one of its measures.
Place = tuple[str, str]


def tabulate(scenario: str, scores: Mapping[int, Mapping[str, float]]) -> pd.DataFrame:
    """Return scores of a scenario, number of a record -> measure -> value, as a table.

    Columns: scenario, measure, replicate, value.
    """
    import pandas as pd

    rows = [
        (scenario, measure, replicate, value)
        for replicate, found in scores.items()
        for measure, value in found.items()
    ]
    return pd.DataFrame(rows, columns=["scenario", "measure", "replicate", "value"])


@dataclass(frozen=True)
class Scores:
    """The scores of several records.

    Attributes
    ----------
    table
        Tables as `tabulate` returns them, joined.
    """

    table: pd.DataFrame

    @property
    def records(self) -> int:
        """The number of records."""
        return int(self.table["replicate"].nunique())

    @cached_property
    def _index(self) -> dict[Place, Array]:
        ordered = self.table.sort_values("replicate", kind="stable")
        groups = ordered.groupby(["scenario", "measure"], sort=False)["value"]
        return {(str(s), str(m)): values.to_numpy(dtype=float) for (s, m), values in groups}

    def find(self, place: Place) -> Array | None:
        """Return a score of all records, shape (records,); None if there is no such score."""
        return self._index.get(place)

    def list_scenarios(self, beginning: str) -> list[str]:
        """Return the names of scenarios that begin so, in the order of the table."""
        names = [scenario for scenario, _ in self._index if scenario.startswith(beginning)]
        return list(dict.fromkeys(names))

    def claim(
        self,
        text: str,
        places: Iterable[Place],
        side: Side,
        threshold: float,
        *,
        of: Callable[[Array], Array] = np.asarray,
    ) -> Claim:
        """Claim that the mean of a score lies below (above) a threshold at all places.

        `of` turns values (records,) into what is compared, not negative.
        """
        parts = []
        for place in places:
            values = self.find(place)
            parts.append((", ".join(place), None if values is None else of(values)))
        return claim_means(text, parts, side, threshold)

    def claim_ratio(
        self, text: str, pairs: Iterable[tuple[Place, Place]], side: Side, threshold: float
    ) -> Claim:
        """Claim that the mean of ratios, one per record, lies below (above) a threshold."""
        parts = []
        for first, second in pairs:
            above, below = self.find(first), self.find(second)
            ratio = None if above is None or below is None else np.abs(above / below)
            parts.append((f"{', '.join(first)} / {', '.join(second)}", ratio))
        return claim_means(text, parts, side, threshold)
