"""What compared runs have in common: cells, schemes and criterion, and whether they are paired."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from owtsweep.comparing.aspects import Aspects
from owtsweep.comparing.comparison import Candidate
from owtsweep.config import require
from owtsweep.results.best_scheme import find_best_schemes
from owtsweep.results.conditions import Condition, Value, order_values, show_value
from owtsweep.results.cube import Cube
from owtsweep.results.expand import expand

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Common:
    """The compared runs and their common properties.

    Attributes
    ----------
    runs, aspects
        The runs, and the study's description of each.
    conditions, grid
        The conditions, and the values of them that all runs have.
    schemes, criterion
        The schemes that all runs have, and the measure by which all are judged.
    boundary
        The two schemes whose boundary is reported, or None.
    samples
        Whether rows are samples, so that intervals exist.
    notes
        Sentences on what was left out.
    """

    runs: Sequence[Candidate]
    aspects: Sequence[Aspects]
    conditions: tuple[Condition, ...]
    grid: dict[str, list[Value]]
    schemes: list[str]
    criterion: str
    boundary: tuple[str, str] | None
    samples: bool
    notes: list[str]

    @property
    def names(self) -> list[str]:
        """The names of the conditions."""
        return [condition.name for condition in self.conditions]

    @property
    def size(self) -> int:
        """The number of common cells."""
        return math.prod(len(values) for values in self.grid.values())

    def choose_rows(self, index: int) -> pd.DataFrame:
        """The rows of a run at common values of the conditions that do not expand."""
        rows = self.runs[index].rows
        for condition in self.conditions:
            if not condition.expands:
                rows = rows[rows[condition.name].isin(self.grid[condition.name])]
        return rows


def find_common(runs: Sequence[Candidate], aspects: Sequence[Aspects]) -> Common:
    """Find what the runs have in common.

    Raises
    ------
    InputError
        If the runs share no cell or no scheme, have different conditions, are judged by different
        criteria, or if the rows of some runs are samples and those of others are not.
    """
    first = aspects[0]
    without = sorted(
        {str(r.config.engine) for r, a in zip(runs, aspects, strict=True) if a.best_of is not None}
    )
    require(
        len({a.best_of is None for a in aspects}) == 1,
        f"engine: some runs are of engine={' or '.join(without)}, which has no records to pair "
        "with those of the others; compare runs of records with each other, and "
        f"{' or '.join(without)} ones with each other",
    )
    criteria = list(dict.fromkeys(a.criterion for a in aspects))
    require(
        len(criteria) == 1,
        f"measures.criterion: the runs are judged by {' and '.join(criteria)}, which are no one "
        "quantity; compare runs of one criterion",
    )
    require(
        all(a.conditions == first.conditions for a in aspects),
        "grid: the runs have different conditions; compare runs of the same ones",
    )
    notes = []
    if without:
        notes.append(
            f"engine={' or '.join(without)} has no records: n is 0, nothing has an interval, and "
            "no change is called established"
        )
    grid: dict[str, list[Value]] = {}
    for name in (condition.name for condition in first.conditions):
        axes = [set(a.grid[name]) for a in aspects]
        shared = axes[0].intersection(*axes[1:])
        key = f"grid.{name}"
        require(bool(shared), f"{key}: the runs have no value in common; run common ones")
        grid[name] = order_values(list(shared), first.grid[name])
        if any(axis != shared for axis in axes):
            kept = ", ".join(map(show_value, grid[name]))
            notes.append(f"{key} differs between the runs; compared is what all have: {kept}")
    schemes = [name for name in first.schemes if all(name in a.schemes for a in aspects)]
    require(bool(schemes), "schemes: the runs have no scheme in common; run common ones")
    left_out = sorted({name for a in aspects for name in a.schemes} - set(schemes))
    if left_out:
        notes.append(f"schemes that not all runs have are left out: {', '.join(left_out)}")
    return Common(
        runs=runs,
        aspects=aspects,
        conditions=first.conditions,
        grid=grid,
        schemes=schemes,
        criterion=criteria[0],
        boundary=first.boundary,
        samples=not without,
        notes=notes,
    )


def find_best(shared: Common, index: int) -> pd.DataFrame:
    """The best scheme of every common cell, as in the run's best_scheme.csv."""
    rows, aspects = shared.choose_rows(index), shared.aspects[index]
    if aspects.best_of is not None:
        return aspects.best_of(rows, shared.grid, shared.schemes, shared.criterion)
    cube = Cube.of_rows(rows, shared.schemes, shared.conditions, shared.grid)
    return find_best_schemes(cube, aspects.window, [shared.criterion])


def arrange_samples(shared: Common) -> list[pd.DataFrame]:
    """The criterion's values in every run: rows (scheme, *conditions), columns replicates.

    The tables have the same rows and columns. NaN where a scheme did not finish a replicate.
    """
    import pandas as pd

    axes = ["scheme", *shared.names]
    tables = []
    for index, aspects in enumerate(shared.aspects):
        values = expand(shared.choose_rows(index), shared.conditions, shared.grid)
        used = values[values["scheme"].isin(shared.schemes)]
        used = used[(used["measure"] == shared.criterion) & (used["window"] == aspects.window)]
        tables.append(used.pivot(index=axes, columns="replicate", values="value"))
    cells = pd.MultiIndex.from_product([shared.schemes, *shared.grid.values()], names=axes)
    replicates = sorted({replicate for table in tables for replicate in table.columns})
    return [table.reindex(index=cells, columns=replicates).astype(float) for table in tables]


def find_unpaired(one: Aspects, other: Aspects) -> list[str]:
    """The keys that give two runs different records; empty if the runs are paired."""
    return [key for key in one.pairing if one.pairing[key] != other.pairing[key]]
